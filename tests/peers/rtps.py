"""RTPS messages on the loopback: who sends what to whom."""
import socket
import struct
import threading
import time

ACKNACK, HEARTBEAT, GAP, INFO_SRC, INFO_DST, DATA, DATA_FRAG = 0x06, 0x07, 0x08, 0x0C, 0x0E, 0x15, 0x16

ETH_P_ALL, SO_RCVBUFFORCE, BUFFER = 3, 33, 64 << 20
ETHERNET = 14  # bytes of the header before IP


class Sniffer:
    """Keeps all datagrams to the ports of a domain (RTPS 2.5, 9.6.2), from now on until `stop`. Needs root or CAP_NET_RAW."""

    def __init__(self, domain):
        self.first = 7400 + 250 * domain
        self.kept, self.ends = [], False
        self.socket = socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.htons(ETH_P_ALL))
        self.socket.bind(("lo", 0))
        try:
            self.socket.setsockopt(socket.SOL_SOCKET, SO_RCVBUFFORCE, BUFFER)
        except PermissionError:
            pass  # the usual one, from which a busy machine may lose some
        self.socket.settimeout(0.1)
        self.thread = threading.Thread(target=self.run, daemon=True)
        self.thread.start()

    def run(self):
        while not self.ends:
            try:
                frame, (_, _, kind, *_) = self.socket.recvfrom(1 << 17)
            except TimeoutError:
                continue
            if kind != socket.PACKET_OUTGOING:  # the loopback shows each twice
                self.kept.append((time.monotonic(), frame[ETHERNET:]))

    def stop(self):
        """(time in s, destination (ip, port), payload) of every whole IPv4 UDP datagram."""
        self.ends = True
        self.thread.join()
        self.socket.close()
        for at, ip in self.kept:
            if len(ip) < 28 or ip[0] >> 4 != 4 or ip[9] != 17 or struct.unpack(">H", ip[6:8])[0] & 0x1FFF:
                continue
            udp = ip[(ip[0] & 15) * 4:]
            port = struct.unpack(">H", udp[2:4])[0]
            if self.first <= port < self.first + 250:
                yield at, (".".join(map(str, ip[16:20])), port), udp[8:]


def submessages(payload):
    """(kind, flags, byte order for struct, body, source prefix, destination prefix) of each."""
    if payload[:4] != b"RTPS":
        return
    source, destination, i = payload[8:20], bytes(12), 20
    while i + 4 <= len(payload):
        kind, flags = payload[i], payload[i + 1]
        order = "<" if flags & 1 else ">"
        length = struct.unpack(order + "H", payload[i + 2:i + 4])[0]
        if length == 0 and kind not in (0x01, 0x09):
            length = len(payload) - i - 4  # the last submessage may leave its length out
        body = payload[i + 4:i + 4 + length]
        if kind == INFO_DST:
            destination = body[:12]
        elif kind == INFO_SRC:
            source = body[8:20]
        yield kind, flags, order, body, source, destination
        i += 4 + length


def number(order, b):
    """A sequence number."""
    high, low = struct.unpack(order + "iI", b[:8])
    return (high << 32) + low


def numbers(order, b):
    """A set of sequence numbers: its base and its members."""
    base, bits = number(order, b), struct.unpack(order + "I", b[8:12])[0]
    words = struct.unpack(f"{order}{(bits + 31) // 32}I", b[12:12 + (bits + 31) // 32 * 4])
    return base, {base + k for k in range(bits) if words[k // 32] >> (31 - k % 32) & 1}


def fragments(order, b):
    """Of a DATA_FRAG: sequence number, first fragment, how many, how many the sample has."""
    first, count, size, total = struct.unpack(order + "IHHI", b[20:32])
    return number(order, b[12:20]), first, count, -(-total // size)
