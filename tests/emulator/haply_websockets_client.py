#!/usr/bin/env python3
"""A client of the Inverse Service by the library that public clients use (websockets, Debian's python3-websockets).

Run as the command of `sparsha device emulate --device haply -- /usr/bin/python3 haply_websockets_client.py`. It offers what
such clients offer by themselves (compression, a close that is answered) and goes on as they do: the first message that comes
names devices, then an answer is read, a force sent under `values` and a 200th of a second waited. A hand is held by
a spring to where it was first; what the service says of position, orientation, buttons and force is checked.
Returns 77 without the library.
"""
import asyncio
import json
import os
import sys

try:
    import websockets
except ImportError:
    print("without python3-websockets")
    sys.exit(77)

RATE_HZ = 200.0
STIFFNESS_N_M = 20.0
MOST_N = 2.0
SECONDS = 4.0
AXES = ("x", "y", "z")


def bounded(force):
    return max(-MOST_N, min(MOST_N, force))


async def touch(address):
    forces, told, places, grips = 0, 0, [], 0
    force = dict.fromkeys(AXES, 0.0)
    async with websockets.connect(address, ping_interval=None, ping_timeout=None) as service:
        identity = None
        end = asyncio.get_running_loop().time() + SECONDS
        while asyncio.get_running_loop().time() < end:
            message = json.loads(await asyncio.wait_for(service.recv(), timeout=1.0))
            device = (message.get("inverse3") or [{}])[0]
            grip = (message.get("wireless_verse_grip") or message.get("verse_grip") or [{}])[0]
            identity = identity or device.get("device_id")
            assert identity, message
            place = [device["state"]["cursor_position"][axis] for axis in AXES]
            places.append(place)
            if grip:
                turn = grip["state"]["orientation"]
                assert abs(sum(turn[part] ** 2 for part in ("w", "x", "y", "z")) - 1.0) < 1e-6, turn
                assert all(isinstance(grip["state"]["buttons"][name], bool) for name in "abc"), grip
                grips += 1
            if forces:
                applied = [device["state"]["current_cursor_force"][axis] for axis in AXES]
                told += max(abs(a - force[axis]) for a, axis in zip(applied, AXES)) < 1e-6
            force = {axis: bounded(STIFFNESS_N_M * (places[0][k] - place[k])) for k, axis in enumerate(AXES)}
            if forces == 0:
                force["z"] = 0.5
            await service.send(json.dumps({"inverse3": [
                {"device_id": identity, "commands": {"set_cursor_force": {"values": force}}}]}))
            forces += 1
            await asyncio.sleep(1.0 / RATE_HZ)
        # A ping comes back, and the end is said and answered.
        await asyncio.wait_for(await service.ping(), timeout=1.0)
    assert service.close_code == 1000, service.close_code
    return forces, told, grips, [max(p[k] for p in places) - min(p[k] for p in places) for k in range(3)]


def main():
    address = f"ws://localhost:{os.environ.get('SPARSHA_HAPLY_PORT', '10001')}"
    forces, told, grips, moved = asyncio.run(touch(address))
    assert forces > 20 and grips > 20, (forces, grips)
    assert told > 0.9 * (forces - 1), f"of {forces} forces {told} were told as they had been sent"
    assert max(moved) < 0.3, moved
    print(f"{forces} forces sent, {told} of them told, the hand moved by {max(moved) * 1e3:.1f} mm")
    return 0


if __name__ == "__main__":
    sys.exit(main())
