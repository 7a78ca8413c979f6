"""Every query of `contrib/duckdb`, on the archive of an agent beside a simulated machine, and on one that is made up."""

import json
import os
import pathlib
import shutil
import signal
import subprocess
import tempfile
import time
import unittest
import urllib.request

from archive import FOLDER, Archive

LEADSCREW = os.environ["LEADSCREW"]
# A thread of three passes, each a thread of its own, and a hole.
PART = "G98\nM3 S600\nG0 X30 Z5\nG92 X29 Z-10 F1.5\nX28.6\nX28.3\nM5\nG0 X0 Z5\nM29 S1000\nG84 Z-5 F1000\nG80\nM30\n"
THREAD_LINES = [4, 5, 6]
HOLE_LINE = 10
EMERGENCY_STOP = 4300
# Figures of the agent.
FINISHED = 'leadscrew_runs_total{machine="lathe1",end="finished"}'
ALARM = f'leadscrew_alarms_total{{machine="lathe1",number="{EMERGENCY_STOP}"}}'
LIMIT = 120


class Shop:
    """A machine and its agent, in a folder of their own."""

    def __init__(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="leadscrew-history-"))
        (self.folder / "run").mkdir()
        self.environment = dict(
            os.environ,
            NO_COLOR="1",
            XDG_RUNTIME_DIR=str(self.folder / "run"),
            XDG_STATE_HOME=str(self.folder / "state"),
            LEADSCREW_BUS="sim:desk",
        )
        self.archive = self.folder / "archive"
        self.does("up")

    def does(self, *words):
        done = subprocess.run([LEADSCREW, *words], env=self.environment, capture_output=True, text=True, timeout=LIMIT)
        if done.returncode != 0:
            raise AssertionError(f"{words}: {done.stderr}")
        return done.stdout

    def agent(self):
        command = [LEADSCREW, "agent", "--archive", str(self.archive), "--machine", "lathe1", "--name", "desk", "--group", "shop"]
        command += ["--metrics", "127.0.0.1:0"]
        agent = subprocess.Popen(command, env=self.environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.figures = next(line.split()[-1] for line in agent.stdout if line.startswith("figures are at "))
        for line in agent.stderr:
            if "is read" in line:
                return agent
        raise AssertionError("the agent reads no machine")

    def ends(self, agent):
        """As a service manager does it."""
        agent.send_signal(signal.SIGTERM)
        agent.communicate(timeout=LIMIT)

    def count(self, of):
        """What the agent has read by now of this."""
        with urllib.request.urlopen(self.figures, timeout=LIMIT) as answer:
            lines = answer.read().decode().splitlines()
        return sum(float(line.split()[-1]) for line in lines if line.startswith(of))

    def wait(self, of, more_than):
        """The agent reads by and by: whoever ends it before keeps it from what has happened."""
        end = time.monotonic() + LIMIT
        while self.count(of) <= more_than:
            if time.monotonic() > end:
                raise AssertionError(f"the agent reads no {of}")
            time.sleep(0.1)

    def part(self):
        program = self.folder / "part.nc"
        program.write_text(PART)
        before = self.count(FINISHED)
        part = json.loads(self.does("run", str(program), "--json"))
        self.wait(FINISHED, before)
        return part

    def remove(self):
        self.does("down", "--name", "desk")
        shutil.rmtree(self.folder)


class OfAMachine(unittest.TestCase):
    """An archive that an agent wrote: two parts, a kill of the agent between them, and an emergency stop."""

    @classmethod
    def setUpClass(cls):
        cls.shop = Shop()
        cls.addClassCleanup(cls.shop.remove)
        agent = cls.shop.agent()
        cls.parts = [cls.shop.part()]
        agent.kill()
        agent.communicate()
        agent = cls.shop.agent()
        cls.parts.append(cls.shop.part())
        # An alarm in the same look at the log would be the end of the part: that has been read by now.
        cls.shop.does("sim", "estop", "press")
        cls.shop.wait(ALARM, 0)
        cls.shop.ends(agent)

    def setUp(self):
        self.archive = Archive(self.shop.archive)

    def test_pitch(self):
        # Its hash is another where it begins from another place.
        hashes = {part["setpoint_hash"] for part in self.parts}
        tools = [(known, line, "T0303") for known in hashes for line in THREAD_LINES]
        self.archive.database.executemany("INSERT INTO tools VALUES (?, ?, ?)", tools)
        [row] = self.archive.query("pitch")
        self.assertEqual((row["machine"], row["tool"], row["threads"], row["known"]), ("lathe1", "T0303", 6, 6))
        cuts = [thread["cut"] for part in self.parts for thread in part["threads"] if thread["kind"] == "thread"]
        errors = [abs(cut["lead_um_per_turn"]) for cut in cuts]
        self.assertAlmostEqual(row["largest_um"], max(errors))
        self.assertAlmostEqual(row["mean_um"], sum(errors) / len(errors))
        self.assertAlmostEqual(row["worst_um"], max(abs(cut["worst_um"]) for cut in cuts))
        self.assertIn(row["largest_um_u"], [cut["lead_um_per_turn_u"] for cut in cuts])

    def test_a_program_that_the_shop_does_not_know_has_no_tool(self):
        self.archive.database.execute("INSERT INTO tools VALUES ('0', 4, 'T0303')")
        [row] = self.archive.query("pitch")
        self.assertEqual((row["tool"], row["threads"]), (None, 6))

    def test_alarms(self):
        [row] = self.archive.query("alarms")
        self.assertEqual((row["alarm"], row["times"], row["machines"]), (EMERGENCY_STOP, 1, 1))
        self.assertIn("emergency stop", row["cause"].lower())
        self.assertTrue(row["remedy"])

    def test_states(self):
        rows = self.archive.query("states")
        states = {row["state"]: row["seconds"] for row in rows}
        self.assertTrue({"idle", "run"} <= set(states), states)
        self.assertAlmostEqual(sum(row["percent"] for row in rows), 100)
        [whole] = self.archive.does(
            "SELECT epoch(max(at_utc) - min(at_utc)) AS seconds FROM ("
            "SELECT at_utc FROM told('state') UNION ALL SELECT at_utc FROM told('presence'))"
        )
        self.assertAlmostEqual(sum(states.values()), whole["seconds"])

    def test_dossier(self):
        keys = self.archive.does("SELECT run_key FROM told('run') ORDER BY number")
        self.assertEqual(len(keys), 2)
        for key, part in zip(keys, self.parts):
            self.archive.set("machine", "lathe1")
            self.archive.set("run", key["run_key"])
            rows = self.archive.query("dossier")
            lines = [row["thread_line"] for row in rows]
            self.assertEqual(lines, [*THREAD_LINES, HOLE_LINE])
            self.assertEqual({row["run_setpoint_hash"] for row in rows}, {part["setpoint_hash"]})
            self.assertTrue(all(row["run_finished"] for row in rows))
            self.assertEqual([row["cut_known"] for row in rows], ["yes", "yes", "yes", "hole"])
            told = [row["cut_worst_um"] for row in rows[:3]]
            said = [thread["cut"]["worst_um"] for thread in part["threads"][:3]]
            self.assertEqual(told, said)

    def test_spindle(self):
        [row] = self.archive.query("spindle")
        self.assertEqual((row["machine"], row["threads"]), ("lathe1", 8))
        self.assertGreaterEqual(row["largest_um"], row["rms_um"])
        self.assertIsNone(row["um_each_month"], "nothing is known of a month")

    def test_each_record_is_there_once(self):
        [row] = self.archive.does(
            "SELECT count(*) AS all, count(DISTINCT number) AS numbers, max(number) AS newest FROM read_parquet("
            "getvariable('archive') || '/*/*/*.parquet', union_by_name = true)"
        )
        self.assertEqual((row["all"], row["numbers"]), (row["newest"], row["newest"]))
        [row] = self.archive.does("SELECT count(*) AS all, count(DISTINCT thread_key) AS keys FROM told('thread')")
        self.assertEqual((row["all"], row["keys"]), (8, 8))
        self.assertEqual(list(self.shop.archive.rglob("*.part")), [])

    def test_files_that_were_copied_count_once(self):
        folder = self.shop.folder / "copied"
        shutil.copytree(self.shop.archive, folder)
        for file in list(folder.rglob("*.parquet")):
            shutil.copy(file, file.with_name(f"again-{file.name}"))
        copied = Archive(folder)
        self.assertEqual(copied.query("spindle")[0]["threads"], 16)
        copied.does("CREATE OR REPLACE MACRO told(kind) AS TABLE FROM once(kind)")
        for name in ["pitch", "alarms", "states", "spindle"]:
            self.assertEqual(copied.query(name), self.archive.query(name), name)

    def test_a_month_as_one_file(self):
        months = self.shop.folder / "months"
        months.mkdir()
        self.archive.set("months", months)
        [row] = self.archive.does("SELECT date_trunc('month', max(at_utc))::DATE::VARCHAR AS month FROM told('thread')")
        self.archive.does(f"SET VARIABLE month = DATE '{row['month']}'")
        for kind in ["thread", "run"]:
            self.archive.set("kind", kind)
            self.archive.query("month")
        files = sorted(str(file.parent.relative_to(months)) for file in months.rglob("*.parquet"))
        self.assertEqual(files, [f"record={kind}/date={row['month']}" for kind in ["run", "thread"]])
        compact = Archive(months)
        for name in ["pitch", "spindle"]:
            self.assertEqual(compact.query(name), self.archive.query(name))


class MadeUp(unittest.TestCase):
    """The certificates that nobody has cut."""

    def test_a_spindle_that_gets_worse_is_the_first(self):
        with tempfile.TemporaryDirectory() as folder:
            archive = Archive(folder)
            archive.set("certificates", 100_000)
            archive.query("made-up")
            [row] = archive.does("SELECT count(*) AS all, count(DISTINCT (machine, thread_key)) AS keys FROM told('thread')")
            self.assertEqual((row["all"], row["keys"]), (100_000, 100_000))
            drift = archive.query("spindle")
            self.assertEqual(drift[0]["machine"], "lathe7")
            self.assertAlmostEqual(drift[0]["um_each_month"], 1, delta=0.1)
            pitch = archive.query("pitch")
            self.assertEqual(sum(row["threads"] for row in pitch), 70_000)
            self.assertEqual(len(pitch), 200 * 12)
            archive.set("machine", "lathe3")
            archive.set("run", "0000a003/1/17")
            self.assertEqual(len(archive.query("dossier")), 10)

    def test_every_query_is_tried(self):
        tried = {"archive", "pitch", "alarms", "states", "dossier", "spindle", "month", "made-up"}
        self.assertEqual({file.stem for file in FOLDER.glob("*.sql")}, tried)


if __name__ == "__main__":
    unittest.main()
