"""A CAN bus that is a TCP connection to one node: 13 bytes a frame (identifier, length, data)."""

import select
import socket
import struct

import can

FRAME = struct.Struct("<IB8s")


class Wire(can.BusABC):
    """The other end of `tests/examples/canopen_node.rs`."""

    def __init__(self, port):
        super().__init__(channel=None)
        self._socket = socket.create_connection(("127.0.0.1", port))
        self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._heard = b""
        self.channel_info = f"node on port {port}"

    def send(self, msg, timeout=None):
        self._socket.sendall(FRAME.pack(msg.arbitration_id, msg.dlc, bytes(msg.data)))

    def _recv_internal(self, timeout):
        if len(self._heard) < FRAME.size:
            if self._socket in select.select([self._socket], [], [], timeout)[0]:
                self._heard += self._socket.recv(4096)
        if len(self._heard) < FRAME.size:
            return None, False
        frame, self._heard = self._heard[: FRAME.size], self._heard[FRAME.size :]
        identifier, length, data = FRAME.unpack(frame)
        message = can.Message(
            arbitration_id=identifier, is_extended_id=False, data=data[:length]
        )
        return message, False

    def shutdown(self):
        super().shutdown()
        self._socket.close()
