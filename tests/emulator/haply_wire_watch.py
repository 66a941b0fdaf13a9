#!/usr/bin/env python3
"""Stands on the wire between `sparsha explore --device haply` and the emulated service, and judges each command.

    sparsha device emulate --device haply -- python3 haply_wire_watch.py SPARSHA RATE_HZ FAULT [nightly]

It shares nothing with the driver or the emulator: frames and JSON are read here. Messages are passed on as they come;
once the program presses, the fault is made here, on the wire: brake, disconnect, malformed, not-framed, silence, sleep,
masked (a frame as only clients send), utf8 (text that is none), huge (a number that is none), far (a place at which no
hand can be) or twice (two places of one hand). What the program commands afterwards is to be zero within one tick.
`odd` is no fault: from then on the service says the same as no client expects but every one has to understand.
"""
import json
import math
import os
import select
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time

PRESSED_N = 0.3
FAULT_S = 0.3  # between brake and release
CALM_S = 0.045  # of the 50 ms in the air after which forces come back, for a judge that is itself late


def frames(data, masked):
    """Whole frames at the beginning of data: (payload, bytes of the frame) each, and what is left."""
    found = []
    while len(data) >= 2:
        size, begin = data[1] & 0x7F, 2
        if size == 126:
            if len(data) < 4:
                break
            size, begin = struct.unpack(">H", data[2:4])[0], 4
        elif size == 127:
            if len(data) < 10:
                break
            size, begin = struct.unpack(">Q", data[2:10])[0], 10
        mask = data[begin:begin + 4] if masked else b""
        begin += len(mask)
        if len(data) < begin + size:
            break
        payload = data[begin:begin + size]
        if masked:
            key = int.from_bytes((mask * (size // 4 + 1))[:size], "big")
            payload = (int.from_bytes(payload, "big") ^ key).to_bytes(size, "big")
        found.append((payload, data[:begin + size]))
        data = data[begin + size:]
    return found, data


def text_frame(text):
    data = text.encode()
    head = bytes([0x81, len(data)]) if len(data) < 126 else b"\x81\x7e" + struct.pack(">H", len(data))
    return head + data


OTHERS = "".join('{"device_id":"OTHER%d","state":{"cursor_position":{"x":9,"y":9,"z":9}}},' % i for i in range(40))


def odd_frames(message):
    """The same state, its keys turned round, its numbers written otherwise, among devices and keys that nobody knows; in
    three frames, between which two pings come."""
    def odd(value):
        if isinstance(value, dict):
            items = [json.dumps(key) + "\t: " + odd(part) for key, part in reversed(list(value.items()))]
            return '{"unknown":[{"x":1E+2}],"unknown":null' + "".join(" ,\n" + item for item in items) + "}"
        if isinstance(value, list):
            return "[ " + ",".join(odd(part) for part in value) + " ]"
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            return json.dumps(value, ensure_ascii=False)
        return "-0" if value == 0 else f"{value:.15e}"

    data = odd(dict(message, currency="\u20ac \U0001F5FF")).replace('"inverse3"\t: [', '"inverse3"\t: [' + OTHERS).encode()
    third = len(data) // 3
    parts = [data[:third], data[third:2 * third], data[2 * third:]]
    frames_of = [bytes([first]) + (b"\x7e" + struct.pack(">H", len(part)) if len(part) > 125 else bytes([len(part)])) + part
                 for first, part in zip((0x01, 0x00, 0x80), parts)]
    return frames_of[0] + b"\x89\x02hi" + frames_of[1] + b"\x89\x00" + frames_of[2]


class Pipe:
    """A client of the tap, and its connection to the service."""

    def __init__(self, client, port, events):
        self.client, self.service = client, socket.create_connection(("localhost", port), timeout=5)
        self.events, self.greeted = events, [False, False]
        self.rest = [b"", b""]
        for end in (self.client, self.service):
            end.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            end.setblocking(True)


class Watch:
    def __init__(self, fault, service_port, events_port):
        self.fault, self.ports = fault, (service_port, events_port)
        self.listeners = []
        for _ in self.ports:
            listener = socket.socket()
            listener.bind(("127.0.0.1", 0))
            listener.listen(4)
            self.listeners.append(listener)
        self.pipes, self.commands = [], []  # commands: (time, newtons, pipe)
        self.identity, self.faulty_s, self.released_s, self.at = "", None, None, None
        self.passed_s = None  # when the last message before the fault was passed on
        self.pongs = set()

    def port(self, which):
        return self.listeners[which].getsockname()[1]

    def event(self, name, data):
        text = text_frame(json.dumps({"name": name, "category": "device", "level": "error", "message": "",
                                      "data": dict(data, device_family="inverse", device_id=self.identity)}))
        for pipe in self.pipes:
            if pipe.events:
                pipe.client.sendall(text)

    def from_client(self, pipe, payload, whole):
        if whole[0] & 0x0F == 10:
            self.pongs.add(payload)
            return
        command = json.loads(payload) if payload[:1] == b"{" else {}
        force = {}
        for one in command.get("inverse3", []):
            told = one.get("commands", {}).get("set_cursor_force", {})
            force = told.get("vector", told.get("values", {}))
        newtons = math.sqrt(sum(float(v) ** 2 for v in force.values()))
        assert math.isfinite(newtons) and newtons <= 4.001, newtons
        self.commands.append((time.monotonic(), newtons, pipe))
        pipe.service.sendall(whole)

    def from_service(self, pipe, payload, whole):
        now = time.monotonic()
        message = json.loads(payload)
        if not self.identity and message.get("inverse3"):
            self.identity = message["inverse3"][0]["device_id"]
        pressed = [n for _, n, _ in self.commands[-20:] if n > PRESSED_N]
        if self.at is None and len(pressed) == 20:
            self.faulty_s, self.at = now, len(self.commands)
            if self.fault == "brake":
                self.event("device-safety-triggered", {"safety_type": "ebrake_triggered"})
            elif self.fault == "sleep":
                self.event("device-sleep", {})
            elif self.fault == "malformed":
                whole = text_frame('{"inverse3":[{"state":{"cursor_position":{"x":0.0,')
            elif self.fault == "not-framed":
                whole = b"\xff" * 40
            elif self.fault in ("masked", "utf8", "huge", "far", "twice"):
                whole = self.spoilt(payload.decode())
        if self.at is None:
            pipe.client.sendall(whole)
            self.passed_s = time.monotonic()
            return
        since_s = now - self.faulty_s
        if self.fault == "odd":
            whole = odd_frames(message)
        if self.fault == "silence" and since_s < 0.06:
            return
        if self.fault == "disconnect" and since_s < FAULT_S:
            whole = text_frame('{"inverse3":[],"verse_grip":[]}')
        if self.fault == "brake" and since_s > FAULT_S and self.released_s is None:
            self.released_s = now
            self.event("device-safety-triggered", {"safety_type": "ebrake_released"})
        pipe.client.sendall(whole)

    def spoilt(self, text):
        place = json.dumps(json.loads(text)["inverse3"][0]["state"]["cursor_position"], separators=(",", ":"))
        known = '"cursor_position":' + place
        assert known in text, text
        if self.fault == "masked":
            data = text.encode()
            return b"\x81\xfe" + struct.pack(">H", len(data)) + b"\0\0\0\0" + data  # a mask that changes nothing
        if self.fault == "utf8":
            data = text.encode()[:-1] + b',"name":"\xc3("}'
            return b"\x81\x7e" + struct.pack(">H", len(data)) + data
        other = {"huge": '"cursor_position":{"x":1e400,"y":0.0,"z":0.0}',
                 "far": '"cursor_position":{"x":30.0,"y":0.0,"z":-30.0}',
                 "twice": known + ',"cursor_position":{"x":0.0,"y":0.0,"z":0.0}'}[self.fault]
        return text_frame(text.replace(known, other))

    def hang_up(self, pipe):
        for end in (pipe.client, pipe.service):
            end.close()
        self.pipes.remove(pipe)

    def pass_on(self, pipe, side):
        source, target = (pipe.client, pipe.service) if side == 0 else (pipe.service, pipe.client)
        data = source.recv(65536)
        if not data:
            self.hang_up(pipe)
            return
        if not pipe.greeted[side]:
            pipe.rest[side] += data
            if b"\r\n\r\n" not in pipe.rest[side]:
                return
            head, data = pipe.rest[side].split(b"\r\n\r\n", 1)
            target.sendall(head + b"\r\n\r\n")
            pipe.rest[side], pipe.greeted[side] = b"", True
        whole_ones, pipe.rest[side] = frames(pipe.rest[side] + data, masked=side == 0)
        for payload, whole in whole_ones:
            if pipe.events:
                target.sendall(whole)
            elif side == 0:
                self.from_client(pipe, payload, whole)
            else:
                self.from_service(pipe, payload, whole)

    def step(self):
        sources = {listener: None for listener in self.listeners}
        for pipe in self.pipes:
            sources[pipe.client], sources[pipe.service] = (pipe, 0), (pipe, 1)
        for ready in select.select(list(sources), [], [], 0.05)[0]:
            if sources[ready] is None:
                which = self.listeners.index(ready)
                self.pipes.append(Pipe(ready.accept()[0], self.ports[which], which == 1))
                continue
            pipe, side = sources[ready]
            if pipe not in self.pipes:
                continue
            try:
                self.pass_on(pipe, side)
            except (ConnectionError, BrokenPipeError):
                if pipe in self.pipes:
                    self.hang_up(pipe)

    def judge(self):
        """What is wrong; empty: nothing."""
        if self.at is None:
            return ["the program never pressed"]
        after = self.commands[self.at:]
        if self.fault == "odd":
            pressing = sum(n > PRESSED_N for t, n, _ in after if t < self.faulty_s + FAULT_S)
            wrong = [] if pressing > 20 else [f"{pressing} commands pressed: it is not understood"]
            if self.pongs != {b"hi", b""}:
                wrong.append(f"pings are answered by {self.pongs}")
            return wrong if self.commands[-1][1] == 0.0 else wrong + ["the last command was no zero"]
        # One may be on its way, and one tick may have begun, when an event comes; an answer that is awaited meets none.
        crossing = 2 if self.fault in ("brake", "sleep") else 0
        until_s = {"brake": self.released_s, "disconnect": self.faulty_s + FAULT_S}.get(self.fault, self.faulty_s)
        if until_s is None:
            return ["the brake was never released"]
        judged = [(t, n) for t, n, _ in after[crossing:] if t < until_s + CALM_S]
        wrong = [f"{n:.3f} N {1e3 * (t - self.faulty_s):.2f} ms after the fault" for t, n in judged if n > 0.0]
        if len(judged) < 3 and self.fault in ("brake", "silence"):
            wrong.append(f"{len(judged)} commands are too few to judge")
        # The program counts from the last message that it had, which a machine that stalls passes on long before.
        if self.fault == "silence" and not (0.005 < judged[0][0] - self.passed_s and
                                            judged[0][0] - self.faulty_s < 0.05):
            wrong.append(f"the first command in silence came {1e3 * (judged[0][0] - self.passed_s):.1f} ms after the last "
                         f"message, {1e3 * (judged[0][0] - self.faulty_s):.1f} ms after the first that was held back")
        if not any(n > PRESSED_N for t, n, _ in after if t > until_s + CALM_S):
            wrong.append("forces never came back")
        if self.commands[-1][1] != 0.0:
            wrong.append(f"the last command was {self.commands[-1][1]:.3f} N")
        return wrong


def main():
    if sys.argv[4:] == ["nightly"] and not os.environ.get("SPARSHA_NIGHTLY"):
        return 77
    program, rate_hz, fault = os.path.abspath(sys.argv[1]), float(sys.argv[2]), sys.argv[3]
    watch = Watch(fault, int(os.environ.get("SPARSHA_HAPLY_PORT", "10001")),
                  int(os.environ.get("SPARSHA_HAPLY_EVENTS_PORT", "10020")))
    with tempfile.TemporaryDirectory() as folder:
        with open(os.path.join(folder, "plane.xyz"), "w") as scan:
            scan.writelines(f"{x * 1e-3} {y * 1e-3} 0\n" for y in range(60) for x in range(60))
        with open(os.path.join(folder, "plane.yaml"), "w") as config:
            config.write(f"scans: [{{file: plane.xyz}}]\nhaptics: {{rate_hz: {rate_hz}}}\n")
        environment = dict(os.environ, SPARSHA_HAPLY_PORT=str(watch.port(0)), SPARSHA_HAPLY_EVENTS_PORT=str(watch.port(1)))
        with open(os.path.join(folder, "said"), "w+") as said:
            explorer = subprocess.Popen([program, "explore", "plane.yaml", "--headless", "--device", "haply"], cwd=folder,
                                        env=environment, stdout=said, stderr=said)
            began, stopped = time.monotonic(), False
            while explorer.poll() is None:
                watch.step()
                done = watch.at is not None and time.monotonic() - watch.faulty_s > FAULT_S + 0.5 and any(
                    n > PRESSED_N and t > watch.faulty_s + FAULT_S for t, n, _ in watch.commands[-50:])
                if not stopped and (done or time.monotonic() - began > 40):
                    stopped = True
                    explorer.send_signal(signal.SIGINT)
                if time.monotonic() - began > 60:
                    explorer.kill()
            wrong = watch.judge()
            times = [t for t, _, _ in watch.commands]
            if wrong:
                said.seek(0)
                print(said.read())
        rate = len(times) / max(1e-9, times[-1] - times[0]) if times else 0.0
        print(f"{fault} at {rate_hz:.0f} Hz: {len(times)} commands, {rate:.0f} a second;",
              "; ".join(wrong) if wrong else "it is understood" if fault == "odd" else "zero force within a tick")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
