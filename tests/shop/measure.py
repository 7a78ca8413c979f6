"""What many machines give to one broker, how much of it is lost when agents are killed, and how fast queries are.

    cargo xtask bench shop kills [--machines 200 --agents 20 --kills 500 --restarts 3 --seed 1 --broker-kills]
    cargo xtask bench shop rate [--machines 200 --agents 20 --seconds 60]
    cargo xtask bench shop query [--certificates 10000000 --threads 2]
"""

import argparse
import collections
import os
import pathlib
import signal
import tempfile
import time

DAY = 86_400


def kills(options):
    from broker import Cut, trial
    from trouble import may_mount

    # A thread of a machine every four seconds, and three states with it.
    period, states = 4000, 3
    threads = max(10, options.kills // 16)
    with tempfile.TemporaryDirectory(prefix="leadscrew-shop-") as folder:
        begun = time.time()
        disks = 2 if may_mount(folder) else 0
        # The first is long: of the agents whose connection is dead and who are not killed, each has to notice it itself.
        cuts = [Cut(0.2, 0.35, told=False, full=False), Cut(0.65, 0.8, told=True, full=disks > 0)]
        done = trial(
            folder,
            options.seed,
            options.agents,
            options.machines // options.agents,
            period,
            threads,
            states,
            options.kills,
            options.restarts,
            signal.SIGKILL if options.broker_kills else signal.SIGTERM,
            saved=options.broker_kills,
            cuts=cuts,
            disks=disks,
        )
        count = done.count
        files = count.compare(folder)
    of_all = options.machines // options.agents * options.agents * threads
    print(f"{options.machines} machines, {options.agents} agents, {time.time() - begun:.0f} s, seed {options.seed}")
    print(f"agents killed {done.kills} times, broker {'killed' if options.broker_kills else 'restarted'} {options.restarts} times")
    print(f"network cut {len(cuts)} times, disks of {disks} agents full once: {count.gone} records given up, and told")
    print(f"threads cut {of_all}: {count.certificates} certificates, {count.forgotten} forgotten by boards before they were read")
    print(f"records {count.records}, {count.repeated} repeated with their number, {files} files of Parquet")
    print(f"wrong: {len(count.wrong)}")
    for wrong in count.wrong[:20]:
        print(f"  {wrong[:200]}")


def rate(options):
    from broker import trial

    # Ten records a second of each machine: eight states, an entry of the log, a certificate.
    shared = pathlib.Path("/dev/shm")
    with tempfile.TemporaryDirectory(dir=shared if shared.is_dir() else None) as folder:
        each = options.machines // options.agents
        done = trial(folder, 1, options.agents, each, 1000, options.seconds, 8, 0, 0)
    sizes = collections.defaultdict(list)
    for topic, payload in done.messages:
        sizes[topic.split("/")[2]].append(len(topic) + len(payload))
    print(f"{len(done.messages)} messages of {options.machines} machines in {options.seconds} s to one listener; wrong: {len(done.count.wrong)}")
    print(f"broker: {done.seconds:.2f} s of a core, {done.seconds / len(done.messages) * 1e6:.0f} µs for each message")
    for kind, of_kind in sorted(sizes.items()):
        print(f"  {kind}: {len(of_kind)}, {sum(of_kind) / len(of_kind):.0f} bytes each with the topic, {max(of_kind)} at most")


def query(options):
    from archive import FOLDER, Archive

    with tempfile.TemporaryDirectory(prefix="leadscrew-made-up-") as folder:
        archive = Archive(folder, options.threads)
        archive.set("certificates", options.certificates)
        begun = time.monotonic()
        archive.query("made-up")
        made = time.monotonic() - begun
        files = list(pathlib.Path(folder).rglob("*.parquet"))
        size = sum(file.stat().st_size for file in files) / 1e6
        print(f"{options.certificates} certificates made in {made:.0f} s: {len(files)} files, {size:.0f} MB; {options.threads} threads")
        print(f"load of the computer: {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores")
        archive.set("machine", "lathe3")
        archive.set("run", "0000a003/1/17")

        def timed(name, words):
            spans, works = [], []
            for _ in range(5):
                begun, worked = time.monotonic(), time.process_time()
                rows = archive.query(name)
                spans.append(time.monotonic() - begun)
                works.append(time.process_time() - worked)
            # The second does not count what others take of the computer.
            print(f"{name}{words}: {min(spans):.2f} to {max(spans):.2f} s, {min(works):.2f} s of processor time, {len(rows)} rows")

        timed("pitch", "")
        timed("spindle", "")
        timed("dossier", "")
        tools = [(f"{part:016x}", line, f"T{(line - 10) // 3 + 1}") for part in range(3) for line in range(10, 17)]
        archive.database.executemany("INSERT INTO tools VALUES (?, ?, ?)", tools)
        timed("pitch", " with tools")


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("what", choices=["kills", "rate", "query"])
    for name, usual in [("machines", 200), ("agents", 20), ("kills", 500), ("restarts", 3), ("seed", 1), ("seconds", 60), ("threads", 2)]:
        options.add_argument(f"--{name}", type=int, default=usual)
    options.add_argument("--certificates", type=int, default=10_000_000)
    options.add_argument("--broker-kills", action="store_true", help="the broker is killed rather than ended")
    given = options.parse_args()
    {"kills": kills, "rate": rate, "query": query}[given.what](given)


if __name__ == "__main__":
    main()
