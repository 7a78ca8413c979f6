"""A broker, agents that are killed, and a listener of other making: what the test and the measurement are made of."""

import collections
import os
import pathlib
import random
import signal
import socket
import subprocess
import threading
import time

import paho.mqtt.client as mqtt
from pysparkplug import DBirth, DData, NBirth

from archive import Archive
from trouble import Disk, Network

MANY = os.environ["MANY"]
MOSQUITTO = os.environ["MOSQUITTO"]
# Nothing takes so long on any computer.
LIMIT = 300
# Messages of an agent that a broker may give again.
RECENT = 256
# MB of a disk that is filled: a store with its reserve, and a little.
SMALL = 16


class Broker:
    """mosquitto on the loopback, with what it keeps in a folder."""

    def __init__(self, folder):
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.port = free.getsockname()[1]
        self.settings = pathlib.Path(folder) / "mosquitto.conf"
        self.settings.write_text(
            f"listener {self.port} 127.0.0.1\nallow_anonymous true\npersistence true\npersistence_location {folder}/\n"
            "max_inflight_messages 0\nmax_queued_messages 0\nuser root\nlog_type none\n"
        )
        self.start()

    def start(self):
        self.process = subprocess.Popen([MOSQUITTO, "-c", self.settings], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        end = time.monotonic() + LIMIT
        while True:
            try:
                socket.create_connection(("127.0.0.1", self.port)).close()
                return
            except OSError:
                if time.monotonic() > end or self.process.poll() is not None:
                    raise
                time.sleep(0.05)

    def stop(self, how=signal.SIGTERM):
        self.process.send_signal(how)
        self.process.wait(LIMIT)

    def restart(self, how=signal.SIGTERM, away=0.5):
        self.stop(how)
        time.sleep(away)
        self.start()

    def save(self):
        """Writes what it keeps to the disk, as it does every half hour and at its end."""
        self.process.send_signal(signal.SIGUSR1)

    def seconds(self):
        """Of processor time that it has had."""
        fields = pathlib.Path(f"/proc/{self.process.pid}/stat").read_text().rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


class Listener:
    """Hears all, with a session that the broker keeps."""

    def __init__(self, port):
        self.messages = []
        self.subscribed = threading.Event()
        self.client = mqtt.Client("listener", clean_session=False)
        self.client.reconnect_delay_set(0.1, 0.2)
        self.client.on_connect = lambda client, *rest: client.subscribe("spBv1.0/#", qos=1)
        self.client.on_subscribe = lambda *rest: self.subscribed.set()
        self.client.on_message = lambda client, data, message: self.messages.append((message.topic, message.payload))
        self.client.connect("127.0.0.1", port)
        self.client.loop_start()
        if not self.subscribed.wait(LIMIT):
            raise AssertionError("the broker takes no subscription")

    def end(self):
        self.client.disconnect()
        self.client.loop_stop()


class Agents:
    """Agents with made-up machines."""

    def __init__(self, folder, port, agents, machines, period, threads, states, disks):
        self.names = [f"agent{number}" for number in range(agents)]
        begin = int(time.time() * 1000)
        self.commands = {
            name: [MANY, f"mqtt://127.0.0.1:{port}", folder, name, machines, begin, period, threads, states, folder] for name in self.names
        }
        # One of the first has a disk of its own each.
        for name, disk in zip(self.names, disks):
            self.commands[name][-1] = disk.folder
        self.over = begin / 1000 + period * threads / 1000
        self.threads, self.machines = threads, machines
        self.processes = {name: self.started(name) for name in self.names}
        self.kills = 0

    def started(self, name):
        command = [str(word) for word in self.commands[name]]
        # What it says of a disk is no mistake.
        return subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def kill(self, name):
        process = self.processes[name]
        if process.poll() is not None:
            raise AssertionError(f"{name} has ended by itself")
        process.kill()
        process.wait()
        process.stdin.close()
        self.kills += 1
        self.processes[name] = self.started(name)

    def end(self):
        for process in self.processes.values():
            process.stdin.close()
        codes = [process.wait(LIMIT) for process in self.processes.values()]
        if any(codes):
            raise AssertionError(f"agents ended with {codes}")

    def remove(self):
        for process in self.processes.values():
            process.kill()
            process.wait()


def told(messages):
    """What a host understands: for each record its agent, machine, metrics. Checks the numbers of the messages."""
    births, sequence, records = {}, {}, []
    recent = collections.defaultdict(lambda: collections.deque(maxlen=RECENT))
    for topic, payload in messages:
        _, _, kind, node, *device = topic.split("/")
        # What a broker has not seen acknowledged it gives again, with the same number, to a listener that comes back.
        is_again = (topic, payload) in recent[node]
        recent[node].append((topic, payload))
        if kind in ("NDEATH", "DDEATH"):
            if kind == "NDEATH":
                continue
            message = DData.decode(payload)
        elif kind == "NBIRTH":
            message = NBirth.decode(payload)
        elif kind == "DBIRTH":
            message = births[node, device[0]] = DBirth.decode(payload)
        else:
            message = DData.decode(payload, birth=births[node, device[0]])
            records.append((node, device[0], {metric.name: metric.value for metric in message.metrics}))
        if is_again:
            continue
        expected = 0 if kind == "NBIRTH" else (sequence[node] + 1) % 256
        if message.seq != expected:
            raise AssertionError(f"{topic}: sequence number {message.seq} and not {expected}")
        sequence[node] = message.seq
    return records


class Count:
    """What came, counted. `wrong` says what should not be."""

    def __init__(self, messages, agents):
        self.wrong = []
        self.repeated = self.forgotten = 0
        self.lost = collections.defaultdict(set)
        by_number = collections.defaultdict(dict)
        newest = {}
        keys = collections.defaultdict(dict)
        covered = collections.defaultdict(list)
        records = told(messages)
        for node, machine, metrics in records:
            number = metrics["Record/Number"]
            before = by_number[node].setdefault(number, metrics)
            if before is not metrics:
                self.repeated += 1
                if before != metrics:
                    self.wrong.append(f"{node}: number {number} has two contents")
                continue
            if newest.get(machine, 0) > number:
                self.wrong.append(f"{machine}: number {number} is not in order")
            newest[machine] = number
            if metrics["Record/Kind"] == "thread":
                key = metrics["Thread/Key"]
                if key in keys[machine]:
                    self.wrong.append(f"{machine}: {key} is doubled")
                keys[machine][key] = number
                covered[machine].append(int(key.rsplit("/", 1)[1]))
            if metrics["Record/Kind"] == "gap" and metrics["Gap/Of"] == "threads":
                gap = range(metrics["Gap/First"], metrics["Gap/Last"] + 1)
                self.forgotten += len(gap)
                covered[machine].extend(gap)
            if metrics["Record/Kind"] == "loss":
                self.lost[node].update(range(metrics["Loss/First"], metrics["Loss/Last"] + 1))
        for node, numbers in by_number.items():
            untold = set(range(1, max(numbers) + 1)) - set(numbers) - self.lost[node]
            if untold:
                self.wrong.append(f"{node}: {len(untold)} records of {max(numbers)} are missing, and no loss tells it")
        for name in agents.names:
            for place in range(agents.machines):
                machine = f"{name}-{place}"
                if covered[machine] != list(range(1, agents.threads + 1)):
                    self.wrong.append(f"{machine}: certificates {covered[machine]}")
        self.certificates = sum(len(of_machine) for of_machine in keys.values())
        self.gone = sum(max(numbers) - len(numbers) for numbers in by_number.values())
        self.records = sum(len(numbers) for numbers in by_number.values())
        self.numbers = {node: max(numbers) for node, numbers in by_number.items()}
        self.keys = keys

    def compare(self, folder):
        """With the archive that the same agents wrote."""
        archive = Archive(pathlib.Path(folder) / "archive")
        rows = archive.does(
            "SELECT node, count(*) AS all, count(DISTINCT number) AS numbers, max(number) AS newest FROM read_parquet("
            "getvariable('archive') || '/*/*/*.parquet', union_by_name = true) GROUP BY node"
        )
        if {row["node"]: row["newest"] for row in rows} != self.numbers:
            self.wrong.append(f"archive and broker have other numbers: {rows}, {self.numbers}")
        for row in rows:
            most = row["newest"] - len(self.lost[row["node"]])
            if row["all"] != row["numbers"] or row["numbers"] < most:
                self.wrong.append(f"archive of {row['node']}: {row}")
        rows = archive.does("SELECT machine, thread_key, number FROM told('thread')")
        archived = collections.defaultdict(dict)
        for row in rows:
            archived[row["machine"]][row["thread_key"]] = row["number"]
        if archived != self.keys:
            self.wrong.append("archive and broker have other certificates")
        return len(list((pathlib.Path(folder) / "archive").rglob("*.parquet")))


# What came, how often agents were killed, all messages, the processor time of the broker since its last start, and how many
# disks were full for their stores.
Trial = collections.namedtuple("Trial", "count kills messages seconds full")


# A cut of the network: parts of the time at which it begins and ends, whether old connections are told of it, and whether
# the disks of the first agents are full meanwhile.
Cut = collections.namedtuple("Cut", "begin end told full")


def trial(folder, seed, agents, machines, period, threads, states, kills, restarts, how=signal.SIGTERM, saved=False, cuts=(), disks=0):
    """Agents work while they are killed at random, the broker is restarted, the network cut, and some disks are full."""
    chance = random.Random(seed)
    broker = Broker(folder)
    crowd = listener = network = None
    small, full = [], set()
    try:
        for number in range(disks):
            small.append(Disk(pathlib.Path(folder) / f"disk{number}", SMALL))
        if cuts:
            network = Network(broker.port)
        listener = Listener(broker.port)
        broker.save()
        port = network.port if network else broker.port
        crowd = Agents(folder, port, agents, machines, period, threads, states, small)
        # Whoever is killed often never waits for a connection that is dead: the last is not.
        mortal = crowd.names[:-1] if cuts else crowd.names
        begun, end = time.time(), crowd.over
        moments = [(begun + (end - begun) * chance.random(), "kill") for _ in range(kills)]
        moments += [(begun + (end - begun) * (number + 1) / (restarts + 1), "restart") for number in range(restarts)]
        for cut in cuts:
            moments += [(begun + (end - begun) * cut.begin, "cut"), (begun + (end - begun) * cut.end, "mend told" if cut.told else "mend")]
            if cut.full:
                # Beyond the cut: what waits is sent from a disk that is full.
                over = cut.end + (cut.end - cut.begin) / 4
                moments += [(begun + (end - begun) * cut.begin, "fill"), (begun + (end - begun) * over, "clear")]
        for moment, what in sorted(moments):
            time.sleep(max(0, moment - time.time()))
            if what == "kill":
                crowd.kill(chance.choice(mortal))
            elif what == "cut":
                network.cut()
            elif what.startswith("mend"):
                network.mend(told=what.endswith("told"))
            elif what == "fill":
                for disk in small:
                    disk.fill()
            elif what == "clear":
                full.update(disk.folder for disk in small if disk.clear(LIMIT))
            else:
                if saved:
                    broker.save()
                broker.restart(how)
        time.sleep(max(0, end - time.time()) + 1)
        complete(listener, crowd)
        crowd.end()
        quiet(listener, 1)
        listener.end()
        return Trial(Count(listener.messages, crowd), crowd.kills, listener.messages, broker.seconds(), len(full))
    finally:
        if crowd:
            crowd.remove()
        if listener:
            listener.end()
        if network:
            network.end()
        broker.stop(signal.SIGKILL)
        for disk in small:
            disk.end()


def complete(listener, agents):
    """Waits until all that the agents have made has come. An agent that has lost its broker, and a computer that is busy,
    may be silent for long before that."""
    end, counted = time.monotonic() + LIMIT, -1
    while time.monotonic() < end:
        quiet(listener, 1)
        messages = list(listener.messages)
        if len(messages) == counted:
            continue
        counted = len(messages)
        count = Count(messages, agents)
        if count.certificates + count.forgotten == len(agents.names) * agents.machines * agents.threads:
            break
    quiet(listener, 1)


def quiet(listener, seconds):
    """Waits until nothing has come for a while."""
    end = time.monotonic() + LIMIT
    count, since = -1, time.monotonic()
    while time.monotonic() - since < seconds and time.monotonic() < end:
        if len(listener.messages) != count:
            count, since = len(listener.messages), time.monotonic()
        time.sleep(0.1)
