# SPDX-License-Identifier: Apache-2.0
"""Requests to a `sinks/live` that are wrong on purpose, and what answers them.

Each is a legal request or conversation in which one mistake is planted, so that its answer is known:
a status of HTTP, a code with which the WebSocket is closed, or GONE where nothing is said. Where
bytes are changed anywhere nothing is known but that the answer is whole.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass, replace
from random import Random

from live_client import MASK, masked, xored

GONE = 0
PROTOCOL_ERROR, BAD_PAYLOAD, POLICY_ERROR, TOO_BIG = 1002, 1007, 1008, 1009
MOST_MESSAGE = 64 * 1024
LIVE, FOXGLOVE, SDK = "weft.live.1", "foxglove.websocket.v1", "foxglove.sdk.v1"


@dataclass(frozen=True)
class Attack:
    kind: str
    first: bytes
    expected: tuple[int, ...] = ()  # nothing: any answer
    then: bytes = b""  # once the first is answered by a WebSocket
    is_rude: bool = False  # resets the connection and waits for no answer


@dataclass
class Request:
    path: str
    fields: list[tuple[str, str]]
    query: str = ""
    method: str = "GET"
    version: str = "HTTP/1.1"

    def bytes(self) -> bytes:
        target = self.path + ("?" + self.query if self.query else "")
        lines = [f"{self.method} {target} {self.version}", *(f"{k}: {v}" for k, v in self.fields)]
        return ("\r\n".join(lines) + "\r\n\r\n").encode("latin-1")

    def without(self, name: str) -> Request:
        return replace(self, fields=[each for each in self.fields if each[0] != name])

    def with_field(self, name: str, value: str) -> Request:
        return replace(self, fields=[*self.without(name).fields, (name, value)])


def frame_header(first: int, form: int, size: int, mask: bytes = MASK) -> bytes:
    """Of a frame with so long a length: 2 or 8 bytes, whether it needs them or not."""
    return bytes([first, 0x80 | (126 if form == 2 else 127)]) + size.to_bytes(form, "big") + mask


def cut(rng: Random, data: bytes) -> bytes:
    return data[:rng.randrange(len(data))]


def changed(rng: Random, data: bytes) -> bytes:
    """With one to four bytes or pieces changed, taken out, put in or said twice."""
    mutant = bytearray(data)
    for _ in range(rng.randrange(1, 5)):
        at = rng.randrange(len(mutant) + 1)
        how = rng.randrange(5)
        if how == 0:
            mutant[at:at + 1] = bytes([rng.randrange(256)])
        elif how == 1 and at < len(mutant):
            mutant[at] ^= 1 << rng.randrange(8)
        elif how == 2:
            del mutant[at:at + rng.randrange(1, 20)]
        elif how == 3:
            mutant[at:at] = rng.randbytes(rng.randrange(1, 20))
        else:
            start = rng.randrange(len(mutant) + 1)
            mutant[at:at] = mutant[start:start + rng.randrange(400)]
    return bytes(mutant)


class Attacks:
    """On the server at the port, which asks for the token."""

    def __init__(self, port: int, token: str) -> None:
        self.port, self.token = port, token
        http = [self.wrong_token, self.foreign_origin, self.foreign_host, self.other_method,
                self.other_path, self.body, self.long_header, self.no_http, self.two_at_once,
                self.cut_request, self.changed_request]
        self.kinds: list[Callable[[Random], Attack]] = http + [
            self.handshake, self.broken_frame, self.wrong_text, self.large_message,
            self.wrong_message, self.wrong_close, self.cut_frame, self.changed_frames, self.reset]

    def attack(self, rng: Random) -> Attack:
        return rng.choice(self.kinds)(rng)

    # --- HTTP ---------------------------------------------------------------------------------

    def request(self, rng: Random, path: str, *fields: tuple[str, str],
                token: str | None = None) -> Request:
        """A legal one, with the token in either place."""
        token = self.token if token is None else token
        all_fields = [("Host", f"127.0.0.1:{self.port}"), *fields]
        if rng.random() < 0.3:
            all_fields.append(("Accept", rng.choice(["*/*", "text/html", "x" * rng.randrange(90)])))
        query = "" if rng.random() < 0.5 else "a=b"
        if token and rng.random() < 0.5:
            all_fields.append(("Authorization", rng.choice(["Bearer ", "bearer "]) + token))
        else:
            query = "&".join(filter(None, [query, f"token={token}"]))
        rng.shuffle(all_fields)
        return Request(path, all_fields, query)

    def upgrade(self, rng: Random, protocol: str = LIVE, token: str | None = None) -> Request:
        return self.request(
            rng, rng.choice(["/ws", "/"]), ("Upgrade", "websocket"), ("Connection", "Upgrade"),
            ("Sec-WebSocket-Version", "13"), ("Sec-WebSocket-Key", "MDEyMzQ1Njc4OWFiY2RlZg=="),
            ("Sec-WebSocket-Protocol", protocol), token=token)

    def any_request(self, rng: Random) -> Request:
        if rng.random() < 0.3:
            return self.upgrade(rng)
        return self.request(rng, rng.choice(["/", "/live.js", "/frames.jsonl"]))

    def wrong_token(self, rng: Random) -> Attack:
        secret, at = self.token, rng.randrange(len(self.token))
        wrong = rng.choice(["", secret[:-1], secret + "x", secret.upper(), secret[::-1], "%00",
                            secret[:at] + "~" + secret[at + 1:], "0123456789abcdef"])
        secrets = ["/", "/frames.jsonl", "/ws", "/nothing"]
        request = (self.upgrade(rng, token=wrong) if rng.random() < 0.3
                   else self.request(rng, rng.choice(secrets), token=wrong))
        if rng.random() < 0.2:
            request.query = ""
            request = request.with_field("Authorization", rng.choice(["Basic " + secret, "Bearer"]))
        return Attack("wrong token", request.bytes(), (401,))

    def foreign_origin(self, rng: Random) -> Attack:
        own = f"http://127.0.0.1:{self.port}"
        origin = rng.choice(["http://evil.example", "null", "", "file://", "http://127.0.0.1:1",
                             own.replace("http", "https"), own.replace("127.0.0.1", "localhost"),
                             own + ".evil.example", own + "\r\nOrigin: http://evil.example"])
        request = self.any_request(rng).with_field("Origin", origin)
        return Attack("foreign origin", request.bytes(), (403,))

    def foreign_host(self, rng: Random) -> Attack:
        """As a page sends it whose name was made to stand for this machine."""
        own = f"127.0.0.1:{self.port}"
        host = rng.choice(["evil.example", f"evil.example:{self.port}", f"[::1]:{self.port}", "",
                           "192.0.2.7", f"{own}.evil.example", "127.0.0.1.evil.example", "[",
                           own + "\r\nHost: evil.example", None])
        request = self.any_request(rng)
        request = request.without("Host") if host is None else request.with_field("Host", host)
        return Attack("foreign host", request.bytes(), (403,))

    def other_method(self, rng: Random) -> Attack:
        request = self.any_request(rng)
        request.method = rng.choice(["POST", "PUT", "DELETE", "OPTIONS", "HEAD", "TRACE", "BREW",
                                     "get"])
        return Attack("other method", request.bytes(), (405,))

    def other_path(self, rng: Random) -> Attack:
        path = rng.choice(["/nothing", "/live.js/x", "/../etc/passwd", "//", "/%2e%2e/", "/ws/", "*",
                           "/frames.jsonl/", "http://evil.example/", "/" + "x" * 2000])
        return Attack("other path", self.request(rng, path).bytes(), (404,))

    def body(self, rng: Random) -> Attack:
        content = rng.randbytes(rng.randrange(1, 2000))
        request = self.any_request(rng)
        request.method = rng.choice(["GET", "POST"])
        if rng.random() < 0.5:
            data = request.with_field("Content-Length", str(len(content))).bytes() + content
        else:
            chunk = f"{len(content):x}\r\n".encode() + content + b"\r\n0\r\n\r\n"
            data = request.with_field("Transfer-Encoding", "chunked").bytes() + chunk
        return Attack("body", data, (413,))

    def long_header(self, rng: Random) -> Attack:
        size = rng.randrange(8_200, 20_000)
        request = self.any_request(rng)
        if rng.random() < 0.3:
            request.path = "/" + "x" * size
        elif rng.random() < 0.5:
            request.fields.append(("X", "x" * size))
        else:
            request.fields += [(f"X-{i}", "value") for i in range(size // 8)]
        return Attack("long header", request.bytes(), (431,))

    def no_http(self, rng: Random) -> Attack:
        start = rng.choice(["hello", "GET / HTTP/9.9", "GET / HTTP/2.0", "GET /", "GET  / HTTP/1.1",
                            "G@T / HTTP/1.1", "/ GET HTTP/1.1", "GET /\x01 HTTP/1.1",
                            "\x16\x03\x01\x02", "GET / HTTP/1.1\r\nHost 127.0.0.1",
                            "GET / HTTP/1.1\r\n: x", "GET / HTTP/1.1\r\nA b: c",
                            "GET / HTTP/1.1\r\nX: a\x00b",
                            "GET / HTTP/1.1\r\nContent-Length: x",
                            "GET / HTTP/1.1\r\nContent-Length: 99999999999999999999"])
        return Attack("no HTTP", start.encode("latin-1") + b"\r\n\r\n", (400,))

    def two_at_once(self, rng: Random) -> Attack:
        request = self.request(rng, rng.choice(["/", "/frames.jsonl"]))
        behind = rng.choice([b"GET / HTTP/1.1\r\n\r\n", b"x", masked(0x81, b"{}")])
        return Attack("two at once", request.bytes() + behind, (400,))

    def cut_request(self, rng: Random) -> Attack:
        return Attack("cut request", cut(rng, self.any_request(rng).bytes()), (GONE,))

    def changed_request(self, rng: Random) -> Attack:
        return Attack("changed request", changed(rng, self.any_request(rng).bytes()))

    # --- WebSockets ---------------------------------------------------------------------------

    def handshake(self, rng: Random) -> Attack:
        """One that names another protocol, or is none."""
        request, key = self.upgrade(rng), "Sec-WebSocket-Key"
        name, value, expected = rng.choice([
            ("Sec-WebSocket-Protocol", None, 400), ("Sec-WebSocket-Protocol", "chat", 400),
            ("Sec-WebSocket-Protocol", "weft.live.2", 400), (key, None, 400),
            (key, "x" * rng.randrange(25, 99), 400), ("Sec-WebSocket-Version", None, 400),
            ("Sec-WebSocket-Version", "8", 426)])
        if rng.random() < 0.3:
            request.path, expected = "/ws", 426
            name, value = rng.choice([("Connection", None), ("Upgrade", None), ("Upgrade", "h2c")])
        request = request.without(name) if value is None else request.with_field(name, value)
        return Attack("handshake", request.bytes(), (expected,))

    def conversation(self, rng: Random, kind: str, last: bytes, *expected: int,
                     protocol: str | None = None) -> Attack:
        """A handshake, some legal messages, and then the last bytes."""
        protocol = protocol or rng.choice([LIVE, FOXGLOVE, SDK])
        before = b"".join(self.legal(rng, protocol) for _ in range(rng.randrange(4)))
        return Attack(kind, self.upgrade(rng, protocol).bytes(), expected, before + last)

    @staticmethod
    def legal(rng: Random, protocol: str) -> bytes:
        """A message of the protocol, whole or in pieces, or what every WebSocket may say."""
        control = [masked(0x89, rng.randbytes(rng.randrange(126))), masked(0x8A, b"")]
        if rng.random() < 0.3:
            return rng.choice(control)
        # None that pauses or ends the run.
        change = rng.choices(["dance", "set nothing.at_all=1", "set filters.every=-5"], [8, 1, 1])[0]
        said = rng.choice([{"type": "ready"}, {"type": "change_request", "number": rng.randrange(9),
                                               "text": change}])
        if protocol in (FOXGLOVE, SDK):
            subscription = {"id": rng.randrange(9), "channelId": rng.randrange(7)}
            said = rng.choice([{"op": "subscribe", "subscriptions": [subscription]},
                               {"op": "unsubscribe", "subscriptionIds": [rng.randrange(9)]},
                               {"op": "fetchAsset"}])
        text = json.dumps(said).encode()
        if rng.random() < 0.8:
            return masked(0x81, text, rng.randbytes(4))
        at = rng.randrange(len(text))
        return masked(0x01, text[:at]) + rng.choice([b"", control[0]]) + masked(0x80, text[at:])

    def broken_frame(self, rng: Random) -> Attack:
        text = b'{"type":"ready"}'
        last = rng.choice([
            bytes([0x81, len(text)]) + text,  # without a mask
            masked(0x81 | rng.choice([0x40, 0x20, 0x10]), text),
            masked(0x80 | rng.choice([3, 4, 5, 6, 7, 11, 12, 13, 14, 15]), text),
            masked(rng.choice([0x08, 0x09, 0x0A]), b""),  # in pieces
            masked(0x89, b"x" * rng.randrange(126, 200)),
            masked(0x80, text),  # goes on with nothing
            masked(0x01, text[:5]) + masked(0x81, text),
            frame_header(0x81, 2, len(text)) + xored(text, MASK),  # longer than they must be
            frame_header(0x81, 8, 300) + xored(b" " * 300, MASK)])
        return self.conversation(rng, "broken frame", last, PROTOCOL_ERROR)

    def wrong_text(self, rng: Random) -> Attack:
        wrong = rng.choice([b"\xff", b"\xc0\x80", b"\xed\xa0\x80", b"\xf5\x80\x80\x80", b"\xe2\x82"])
        text = b'{"type":"' + b"x" * rng.randrange(50) + wrong
        return self.conversation(rng, "wrong text", masked(0x81, text), BAD_PAYLOAD)

    def large_message(self, rng: Random) -> Attack:
        if rng.random() < 0.2:
            last = masked(0x01, b" " * MOST_MESSAGE) + masked(0x80, b"x" * rng.randrange(1, 20))
        else:
            size = rng.choice([MOST_MESSAGE + 1, 2**24, 2**31, 2**63 - 1, 2**63, 2**64 - 1])
            last = frame_header(0x81, 8, size) + b" " * rng.randrange(100)
        return self.conversation(rng, "large message", last, TOO_BIG)

    def wrong_message(self, rng: Random) -> Attack:
        number = rng.choice([None, -1, 1.5, "1", [], 1e300])
        said = rng.choice([
            b"", b"hello", b"[", b"[1]", b"7", b'"ready"', b"null", b'{"type":"ready"',
            b'{"type":"ready"}}', b"[" * rng.randrange(1, 30_000), b"{}", b'{"type":7}',
            b'{"type":"stop"}', b'{"type":NaN}', b'{"type":"change_request","text":"dance"}',
            json.dumps({"type": "change_request", "number": number, "text": "dance"}).encode(),
            b'{"type":"change_request","number":1}', b'{"type":"change_request","number":1,"text":null}',
            b'{"type":"change_request","number":1,"text":"a\\u0000b"}'])
        if rng.random() < 0.1:
            return self.conversation(rng, "wrong message", masked(0x82, said), POLICY_ERROR,
                                     protocol=LIVE)
        return self.conversation(rng, "wrong message", masked(0x81, said), POLICY_ERROR)

    def wrong_close(self, rng: Random) -> Attack:
        code = rng.choice([0, 999, 1004, 1005, 1006, 1014, 1015, 1016, 2999])
        payload = rng.choice([b"x", code.to_bytes(2, "big"), code.to_bytes(2, "big") + b"bye",
                              b"\x03\xe8\xff\xff"])
        return self.conversation(rng, "wrong close", masked(0x88, payload), PROTOCOL_ERROR)

    def cut_frame(self, rng: Random) -> Attack:
        whole = masked(0x81, b'{"type":"ready","and":"' + b"x" * rng.randrange(500) + b'"}')
        return self.conversation(rng, "cut frame", cut(rng, whole), GONE)

    def changed_frames(self, rng: Random) -> Attack:
        legal = self.conversation(rng, "", masked(0x88, b"\x03\xe8"))
        return replace(legal, kind="changed frames", then=changed(rng, legal.then))

    def reset(self, rng: Random) -> Attack:
        legal = self.conversation(rng, "", cut(rng, masked(0x81, b'{"type":"ready"}')))
        then = rng.choice([b"", legal.then])
        first = legal.first if then else cut(rng, self.any_request(rng).bytes())
        return Attack("reset", first, then=then, is_rude=True)
