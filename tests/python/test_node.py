"""The core's CANopen services against the Python package `canopen`: `python -m unittest`, with the node's program in
the variable CANOPEN_NODE."""

import logging
import os
import random
import subprocess
import time
import unittest

import canopen
from canopen.objectdictionary import ODVariable, ObjectDictionary, datatypes

from patience import PATIENCE
from wire import Wire

ANY, RANGED, LOSE, ALARM, COPY, COPIED = 0x2000, 0x2001, 0x2002, 0x2003, 0x2004, 0x2005
LENGTHS = [1, 2, 3, 4, 5, 6, 7, 8, 13, 14, 15, 888, 889, 890, 1778, 5000]
# How long disconnecting may take.
canopen.Network.NOTIFIER_CYCLE = 0.05


class NodeTest(unittest.TestCase):
    def setUp(self):
        logging.disable(logging.CRITICAL)
        self.dice = random.Random(int(os.environ["LEADSCREW_SEED"]))
        self.program = subprocess.Popen(
            [os.environ["CANOPEN_NODE"]], stdout=subprocess.PIPE, text=True
        )
        port = int(self.program.stdout.readline())
        self.network = canopen.Network(Wire(port))
        self.node = canopen.RemoteNode(1, ObjectDictionary())
        self.network.add_node(self.node)
        self.network.connect()
        self.node.sdo.RESPONSE_TIMEOUT = PATIENCE

    def tearDown(self):
        self.network.disconnect()
        self.assertEqual(self.program.wait(PATIENCE), 0)
        self.program.stdout.close()

    def until(self, happened):
        deadline = time.time() + PATIENCE
        while not happened():
            self.assertLess(time.time(), deadline, "it did not happen")
            time.sleep(0.005)

    def write_word(self, index, value):
        self.node.sdo.download(index, 0, value.to_bytes(2, "little"))

    def refused(self, code, action):
        with self.assertRaises(canopen.SdoAbortedError) as caught:
            action()
        self.assertEqual(caught.exception.code, code)

    def write_blocks(self, data, crc=True):
        with self.node.sdo.open(
            ANY, 0, "wb", size=len(data), block_transfer=True, request_crc_support=crc
        ) as stream:
            stream.write(data)

    def read_blocks(self, crc=True):
        with self.node.sdo.open(
            ANY, 0, "rb", block_transfer=True, request_crc_support=crc
        ) as stream:
            return stream.read()

    def test_expedited_and_segmented(self):
        self.assertEqual(self.node.sdo.upload(0x1000, 0), (402).to_bytes(4, "little"))
        self.assertEqual(self.node.sdo.upload(0x1008, 0), b"Leadscrew test node")
        for length in [0] + LENGTHS:
            data = self.dice.randbytes(length)
            for force in (False, True):
                self.node.sdo.download(ANY, 0, data, force_segment=force)
                self.assertEqual(self.node.sdo.upload(ANY, 0), data)

    def test_blocks(self):
        for length in LENGTHS + [70_000]:
            for crc in (True, False):
                data = self.dice.randbytes(length)
                self.write_blocks(data, crc)
                self.assertEqual(self.read_blocks(), data)
                self.assertEqual(self.read_blocks(crc), data)

    def test_a_segment_that_is_lost_is_sent_again(self):
        # The last of a block is not among them: without it nobody knows that the block is over.
        for lost in (3, 60, 127, 130, 200):
            data = self.dice.randbytes(7 * 300)
            self.write_word(LOSE, lost)
            self.write_blocks(data)
            self.assertEqual(self.node.sdo.upload(ANY, 0), data)

    def test_abort_codes(self):
        sdo = self.node.sdo
        self.refused(0x0602_0000, lambda: sdo.upload(0x2FFF, 0))
        self.refused(0x0609_0011, lambda: sdo.upload(RANGED, 1))
        self.refused(0x0601_0002, lambda: sdo.download(0x1000, 0, b"\0\0\0\0"))
        self.refused(0x0607_0012, lambda: sdo.download(RANGED, 0, b"\0\0\0"))
        self.refused(0x0607_0013, lambda: sdo.download(RANGED, 0, b"\0"))
        self.refused(0x0609_0031, lambda: self.write_word(RANGED, 101))
        self.refused(0x0609_0032, lambda: self.write_word(RANGED, 9))
        self.write_word(RANGED, 100)
        self.assertEqual(sdo.upload(RANGED, 0), b"\x64\x00")

    def test_network_management_and_heartbeat(self):
        self.write_word(0x1017, 20)
        nmt = self.node.nmt
        self.assertEqual(nmt.wait_for_heartbeat(PATIENCE), "PRE-OPERATIONAL")
        nmt.state = "OPERATIONAL"
        self.until(lambda: nmt.wait_for_heartbeat(PATIENCE) == "OPERATIONAL")
        self.assertEqual(self.node.sdo.upload(RANGED, 0), b"\x32\x00")
        nmt.state = "STOPPED"
        self.until(lambda: nmt.wait_for_heartbeat(PATIENCE) == "STOPPED")
        self.node.sdo.RESPONSE_TIMEOUT = 0.2
        with self.assertRaises(canopen.SdoCommunicationError):
            self.node.sdo.upload(RANGED, 0)
        # Listened for from before the command on: the answer may come before anybody could begin to wait for it.
        states = []
        nmt.add_heartbeat_callback(states.append)
        nmt.state = "RESET COMMUNICATION"
        self.until(lambda: 0 in states)
        self.assertEqual(nmt.wait_for_heartbeat(PATIENCE), "PRE-OPERATIONAL")

    def test_emergencies_and_their_history(self):
        self.write_word(ALARM, 317)
        self.until(lambda: self.node.emcy.log)
        [error] = self.node.emcy.log
        self.assertEqual((error.code, error.register, error.data[:2]), (0xFF00, 0x81, b"\x3d\x01"))
        self.assertEqual(self.node.sdo.upload(0x1001, 0), b"\x81")
        self.assertEqual(self.node.sdo.upload(0x1003, 1), b"\x00\xff\x3d\x01")
        self.write_word(ALARM, 0)
        self.until(lambda: not self.node.emcy.active)
        self.assertEqual(self.node.emcy.active, [])
        self.assertEqual(self.node.sdo.upload(0x1001, 0), b"\0")
        self.node.sdo.download(0x1003, 0, b"\0")
        self.assertEqual(self.node.sdo.upload(0x1003, 0), b"\0")
        self.refused(0x0800_0024, lambda: self.node.sdo.upload(0x1003, 1))

    def copy(self, protocol):
        """Lets the node be the client of a server of this package's own."""
        self.write_word(COPY, protocol << 8 | 2)
        # The node answers when it is done.
        return int.from_bytes(self.node.sdo.upload(COPIED, 0), "little")

    def test_as_client(self):
        dictionary = ObjectDictionary()
        for index in (0x2010, 0x2011):
            variable = ODVariable("domain", index, 0)
            variable.data_type = datatypes.DOMAIN
            variable.access_type = "rw"
            dictionary.add_object(variable)
        other = self.network.create_node(2, dictionary)
        for length in LENGTHS:
            data = self.dice.randbytes(length)
            other.set_data(0x2010, 0, data)
            self.assertEqual(self.copy(0), 1)
            self.assertEqual(other.get_data(0x2011, 0), data)
        # That server has no blocks: it reads the other way and refuses to be written to.
        self.assertEqual(self.copy(1), 0x0504_0001)
        del dictionary[0x2011]
        self.assertEqual(self.copy(0), 0x0602_0000)


if __name__ == "__main__":
    unittest.main()
