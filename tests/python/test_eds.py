"""The electronic data sheet that `leadscrew params docs --eds` prints (its file is in the variable CANOPEN_EDS), as the
Python package `canopen` reads it, and the board's process data decoded with it."""

import os
import struct
import unittest

import canopen
from canopen import objectdictionary
from canopen.objectdictionary import datatypes


class SheetTest(unittest.TestCase):
    def setUp(self):
        self.dictionary = objectdictionary.import_od(os.environ["CANOPEN_EDS"], 5)
        self.network = canopen.Network()
        self.node = canopen.RemoteNode(5, self.dictionary)
        self.network.add_node(self.node)

    def test_device(self):
        device = self.dictionary.device_information
        self.assertEqual(device.allowed_baudrates, {500_000, 1_000_000})
        self.assertEqual((device.nr_of_RXPDO, device.nr_of_TXPDO), (4, 5))
        self.assertEqual(device.product_number, 0x4C53_4357)

    def test_identifiers_follow_the_node(self):
        self.assertEqual(self.dictionary[0x1014].default, 0x85)
        self.assertEqual(self.dictionary[0x1400][1].default, 0x205)
        self.assertEqual(self.dictionary[0x1801][1].default, 0x4000_0285)

    def test_kinds_ranges_and_access(self):
        order = self.dictionary["Command"]["order"]
        self.assertEqual((order.data_type, order.min, order.max), (datatypes.UNSIGNED8, 0, 39))
        error = self.dictionary["Status"]["synchronism error"]
        self.assertEqual(error.data_type, datatypes.INTEGER16)
        self.assertEqual(self.dictionary["Program"]["batch of calls"].access_type, "wo")
        self.assertEqual(self.dictionary["Status"]["record"].data_type, datatypes.DOMAIN)
        # A parameter: No. 19 is index 2000h + 19.
        run_out = self.dictionary[0x2000 + 19]
        self.assertEqual(run_out.access_type, "rw")
        self.assertLess(run_out.min, run_out.max)

    def test_every_object_is_read(self):
        for index in self.dictionary:
            entry = self.dictionary[index]
            # Sub-index 0 of the error history is how many there are now.
            if isinstance(entry, objectdictionary.ODVariable) or index == 0x1003:
                continue
            self.assertEqual(entry[0].default, max(entry.subindices), f"{index:04X}h")

    def hear(self, number, data):
        pdo = self.node.tpdo[number]
        pdo.on_message(pdo.cob_id, bytearray(data), 0.0)
        return {variable.name: variable.raw for variable in pdo}

    def test_process_data(self):
        self.node.tpdo.read(from_od=True)
        self.node.rpdo.read(from_od=True)
        self.assertEqual([self.node.tpdo[n].cob_id for n in (1, 2, 3)], [0x185, 0x285, 0x385])
        status = self.hear(1, [7, 0x09, 0x3D, 0x01, 7, 3, 0x34, 0x12])
        self.assertEqual(
            status,
            {
                "Status.state": 7,
                "Status.flags": 9,
                "Status.alarm": 317,
                "Status.count of the last order": 7,
                "Status.late setpoints": 3,
                "Status.program credit": 0x1234,
            },
        )
        place = self.hear(2, struct.pack("<II", 12, 345))
        self.assertEqual(place, {"Status.line": 12, "Status.move": 345})
        spindle = self.hear(3, struct.pack("<Hih", 0x8000, -300_000, -38))
        self.assertEqual(
            spindle,
            {
                "Status.spindle angle": 0x8000,
                "Status.spindle speed": -300_000,
                "Status.synchronism error": -38,
            },
        )
        command = self.node.rpdo[1]
        self.assertEqual((command.cob_id, len(command.data)), (0x205, 8))
        command["Command.count"].raw = 7
        command["Command.order"].raw = 2
        for override in ("feed", "rapid", "spindle"):
            command[f"Command.{override} override"].raw = 255
        command["Command.echo"].raw = 0x0102
        self.assertEqual(bytes(command.data), bytes([7, 2, 0, 255, 255, 255, 2, 1]))


if __name__ == "__main__":
    unittest.main()
