// Lets the machine's time pass: so many ticks a frame as the speed asks, fewer where the browser is too slow.

const LONGEST_FRAME_MS = 100;
const TICKS_AT_ONCE = 20_000;

export class Runner {
  // `speed` gives machine time over real time; `seen` takes each answer; `failed` takes what went wrong.
  constructor({ ask, speed, seen, failed }) {
    Object.assign(this, { ask, speed, seen, failed, round: 0 });
  }

  stop() {
    this.round += 1;
  }

  async start() {
    this.stop();
    const round = this.round;
    let before = performance.now();
    let owed = 0;
    // The tick of the machine: from the time that it says after the first ticks.
    let ticksPerMs = 1;
    while (round === this.round) {
      const now = performance.now();
      owed += Math.min(now - before, LONGEST_FRAME_MS) * this.speed() * ticksPerMs;
      before = now;
      const ticks = Math.min(Math.floor(owed), TICKS_AT_ONCE);
      // What the browser cannot do is left out, not made up for later.
      owed = Math.min(owed - ticks, TICKS_AT_ONCE);
      if (ticks > 0) {
        const said = await this.ask({ do: "step", ticks }).catch((failure) => ({ failure }));
        if (round !== this.round) return;
        if (said.failure || said.refused) return this.failed(said);
        if (said.state.time_ms > 0) ticksPerMs = said.state.ticks / said.state.time_ms;
        this.seen(said);
        if (said.state.over) return;
      }
      await new Promise((resolve) => setTimeout(resolve, 16));
    }
  }
}
