#!/usr/bin/env python3
"""A client of the Inverse Service that shares nothing with the driver: WebSocket (RFC 6455) and JSON of Python's own library.

Run as the command of `sparsha device emulate --device haply -- python3 haply_plain_client.py`. It speaks as public clients
do: a request for the whole state, probes, forces under `values` and under `vector`, another basis. Prints what it
finds and returns 1 where something is not as the vendor documents.
"""
import base64
import hashlib
import json
import os
import socket
import struct
import sys
import time

GUID = b"258EAFA5-E914-47DA-95CA-C5AB0DC85B11"


class Socket:
    """A client's end."""

    def __init__(self, port):
        self.raw = socket.create_connection(("localhost", port), timeout=5)
        self.raw.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        key = base64.b64encode(os.urandom(16))
        self.raw.sendall(b"GET / HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                         b"Sec-WebSocket-Key: " + key + b"\r\nSec-WebSocket-Version: 13\r\n\r\n")
        self.bytes = b""
        while b"\r\n\r\n" not in self.bytes:
            self.more()
        head, self.bytes = self.bytes.split(b"\r\n\r\n", 1)
        lines = head.split(b"\r\n")
        assert lines[0].startswith(b"HTTP/1.1 101"), head
        fields = {name.strip().lower(): value.strip() for name, value in (line.split(b":", 1) for line in lines[1:])}
        assert fields[b"sec-websocket-accept"] == base64.b64encode(hashlib.sha1(key + GUID).digest()), head
        assert fields[b"upgrade"].lower() == b"websocket" and b"upgrade" in fields[b"connection"].lower()

    def more(self):
        part = self.raw.recv(65536)
        assert part, "the service closed"
        self.bytes += part

    def take(self, count):
        while len(self.bytes) < count:
            self.more()
        part, self.bytes = self.bytes[:count], self.bytes[count:]
        return part

    def receive(self):
        """A whole message, its frames put together."""
        whole = b""
        while True:
            first, second = self.take(2)
            assert second & 0x80 == 0, "a server does not mask"
            size = second & 0x7F
            if size == 126:
                size, = struct.unpack(">H", self.take(2))
            elif size == 127:
                size, = struct.unpack(">Q", self.take(8))
            payload = self.take(size)
            if first & 0x0F >= 8:
                assert first & 0x0F == 10, "neither pings nor an end are expected"
                continue
            whole += payload
            if first & 0x80:
                return json.loads(whole)

    def send(self, message, kind=1):
        text = message if isinstance(message, bytes) else json.dumps(message).encode()
        mask = os.urandom(4)
        size = struct.pack("B", 0x80 | len(text)) if len(text) < 126 else struct.pack(">BH", 0xFE, len(text))
        self.raw.sendall(bytes([0x80 | kind]) + size + mask + bytes(b ^ mask[i % 4] for i, b in enumerate(text)))

    def ask(self, message):
        self.send(message)
        return self.receive()


def vector(told):
    return [told[axis] for axis in "xyz"]


def force_of(identity, key, force):
    return {"inverse3": [{"device_id": identity,
                          "commands": {"set_cursor_force": {key: dict(zip("xyz", force))}}}]}


def main():
    port = int(os.environ.get("SPARSHA_HAPLY_PORT", "10001"))
    service = Socket(port)
    inventory = service.receive()
    identity = inventory["inverse3"][0]["device_id"]
    assert inventory["session_id"] > 0 and "config" in inventory["inverse3"][0], inventory
    assert inventory["inverse3"][0]["config"]["basis"]["permutation"] == "XYZ", inventory

    # A message in, a message out; nothing comes by itself; probes are no force.
    answer = service.ask({"inverse3": [{"device_id": identity, "commands": {"probe_position": {}}}]})
    assert "config" not in answer["inverse3"][0], "usual answers leave the configuration out"
    assert vector(answer["inverse3"][0]["state"]["current_cursor_force"]) == [0, 0, 0]
    service.raw.settimeout(0.2)
    try:
        service.receive()
        raise AssertionError("an answer that nobody asked for")
    except socket.timeout:
        service.raw.settimeout(5)
    full = service.ask({"session": {"force_render_full_state": {}}})
    assert full["inverse3"][0]["config"]["preset"] == "defaults", full

    # What is commanded arrives, under the old and the new key, and is forgotten a tick later.
    for key in ("values", "vector"):
        answer = service.ask(force_of(identity, key, (0.1, -0.2, 0.7)))
        told = vector(answer["inverse3"][0]["state"]["current_cursor_force"])
        assert max(abs(a - b) for a, b in zip(told, (0.1, -0.2, 0.7))) < 1e-9, (key, told)
    time.sleep(0.02)
    second = Socket(port)
    assert second.receive()["session_id"] != inventory["session_id"]
    answer = second.ask({"inverse3": []})
    assert vector(answer["inverse3"][0]["state"]["current_cursor_force"]) == [0, 0, 0], "held for one tick only"

    # Forces of two sessions add up.
    most = 0.0
    for _ in range(200):
        service.send(force_of(identity, "vector", (0, 0, 0.5)))
        answer = second.ask(force_of(identity, "vector", (0, 0, 0.25)))
        most = max(most, answer["inverse3"][0]["state"]["current_cursor_force"]["z"])
        service.receive()
    assert abs(most - 0.75) < 1e-9, most

    # Another basis and preset, for this session alone; what the client sends is read in it as well.
    before = vector(service.ask({"inverse3": []})["inverse3"][0]["state"]["cursor_position"])
    told = second.ask({"session": {"configure": {"profile": {"name": "plain"}, "basis": {"permutation": "X-ZY"}},
                                   "force_render_full_state": {}},
                       "inverse3": [{"device_id": identity, "configure": {"preset": {"preset": "arm_front_centered"}}}]})
    assert told["inverse3"][0]["config"]["basis"]["permutation"] == "X-ZY", told
    assert told["inverse3"][0]["config"]["preset"] == "arm_front_centered", told
    # A force holds for one tick, in which another session asks in vain where the machine is busy: until both see it.
    for _ in range(2000):
        second.send(force_of(identity, "values", (0.3, 0.4, 0.5)))
        service.send({"inverse3": []})
        answer = second.receive()
        told, own = (vector(message["inverse3"][0]["state"]["current_cursor_force"])
                     for message in (answer, service.receive()))
        if any(told) and any(own):
            break
    assert told == [0.3, 0.4, 0.5], answer
    assert own == [0.3, 0.5, -0.4], own
    centred = vector(answer["inverse3"][0]["state"]["cursor_position"])
    assert abs(centred[0] - before[0]) < 0.01 and abs(centred[1] + before[2]) > 0.1, (before, centred)

    # A ping is answered, and what is no JSON or no number of it harms nobody.
    service.send(b"still there", kind=9)
    for text in (b"{", b"[]", b"7", b'{"inverse3":7}', b'{"inverse3":[7,{"device_id":7}]}', b'{"session":null}',
                 b'{"inverse3":[{"device_id":"' + identity.encode() + b'","commands":{"set_cursor_force":'
                 b'{"vector":{"x":"1"}}}}]}'):
        service.send(text)
        service.receive()

    began, answers = time.monotonic(), 0
    while time.monotonic() - began < 0.5:
        service.ask(force_of(identity, "vector", (0, 0, 0)))
        answers += 1
    print(f"the emulated service answers as documented, {2 * answers} answers a second")
    return 0


if __name__ == "__main__":
    sys.exit(main())
