//! What stands below the help of each command: lines that can be typed as they are.

/// Of the program itself.
pub(super) const ALL: &str = "\
Examples:
  leadscrew check examples/o0013-g76-m68x6.nc      find mistakes before anything moves
  leadscrew expand examples/o0013-g76-m68x6.nc     see every move of the cycle
  leadscrew plot examples/shaft.nc -o shaft.svg    a picture of path, speed and synchronism
  leadscrew run examples/shaft.nc                  run it on the simulated machine
  leadscrew simulate PROG -o setpoints.csv         the setpoints, tick by tick
  leadscrew up                                     a simulated machine that stays, for all that follows

Exit codes:
  0    done, warnings included
  1    the program or the parameters are wrong, or a check asked for has failed
  2    the command line is wrong
  3    no bus, no board, or the link was lost
  4    the machine stopped on an alarm while running, or stands on it
  130  interrupted; the board was brought to a controlled stop first";

pub(super) const MODE: &str = "\
Examples:
  leadscrew mode manual --bus can0
  leadscrew mode automatic --bus can0      `run` does this by itself where the machine stands";

pub(super) const JOG: &str = "\
Examples:
  leadscrew jog Z- --hold --bus can0             until Enter or Ctrl-C
  leadscrew jog X+ Z+ --hold --rapid --bus can0  both axes
  leadscrew jog S+ --hold --bus can0             the spindle as M03 turns it, at the speed of 9049
  leadscrew jog X- --by 0.02 --bus can0          0.02 mm of the diameter
  leadscrew jog Z+ --by 25 --bus can0";

pub(super) const TUNE: &str = "\
Examples:
  leadscrew tune Z- --dead-time 1000 --bus can0             moves, and tells what it finds
  leadscrew tune X+ --bus can0 -o x.svg                     with the dead time of 9003
  leadscrew tune Z- --dead-time 1000 --write --bus can0     and writes it
  leadscrew tune spindle --speeds 210,500,890 --bus can0    ramp and ripple of the spindle";

pub(super) const HANDWHEEL: &str = "\
Examples:
  leadscrew handwheel Z x10 -250 --bus can0     2.5 mm towards minus, where the increment is 0.001 mm
  leadscrew handwheel X x1 20 --bus can0        0.02 mm of the diameter
  leadscrew handwheel path x10 400 --bus can0   4 mm of the path of `leadscrew run PROGRAM --handwheel`";

pub(super) const RETRACT: &str = "\
Examples:
  leadscrew status --state board.flash              is a tap in a hole?
  leadscrew retract --dry-run --state board.flash   what would move
  leadscrew retract --speed 200 --state board.flash
  leadscrew retract --discard --state board.flash   the tap was taken out by hand";

pub(super) const EXPLAIN: &str = "\
Examples:
  leadscrew explain 4036
  leadscrew explain                                one line for each number
  leadscrew explain --docs > alarms.md";

pub(super) const CHECK: &str = "\
Examples:
  leadscrew check part.nc
  leadscrew check --strict *.nc            a lead-in that is too short fails too
  leadscrew check --json part.nc           for editors and scripts
  leadscrew check --set 1430.Z=4000 part.nc";

pub(super) const EXPAND: &str = "\
Examples:
  leadscrew expand part.nc
  leadscrew expand part.nc --format jsonl | jq 'select(.cycle == \"G76\")'
  leadscrew expand part.nc --format csv > moves.csv";

pub(super) const SIMULATE: &str = "\
Examples:
  leadscrew simulate part.nc                                    only the summary
  leadscrew simulate part.nc -o setpoints.csv
  leadscrew simulate part.nc --spindle-ripple 10@5 --tolerance 1.3
  leadscrew simulate part.nc --drive X=technosoft-ipos --drive Z=kv30
  leadscrew simulate part.nc --at X=100,Z=50 --json";

pub(super) const DRIVES: &str = "\
Examples:
  leadscrew drives list
  leadscrew drives show technosoft-ipos
  leadscrew simulate part.nc --drive technosoft-ipos    what such a drive cuts";

pub(super) const DRIVES_LIST: &str = "\
Example:
  leadscrew drives list --json";

pub(super) const DRIVES_SHOW: &str = "\
Examples:
  leadscrew drives show kollmorgen-akd
  leadscrew drives show my-drive.toml    a profile of your own";

pub(super) const PLOT: &str = "\
Examples:
  leadscrew plot examples/shaft.nc -o shaft.svg
  leadscrew plot part.nc -o part.svg --spindle-ripple 10@5
  leadscrew plot part.nc -o part.svg --path     the tool path alone: nothing is run";

pub(super) const MEASURE: &str = "\
Examples:
  leadscrew measure part.nc                               the thread is guessed
  leadscrew measure part.nc --thread M40x3-6g --tool V60:r0.2
  leadscrew measure part.nc --spindle-ripple 10@5         what an uneven spindle does to it
  leadscrew measure part.nc --thread M40x3-6g -o part.html      picture and sheet";

pub(super) const RECORD: &str = "\
Examples:
  leadscrew record --bus can0 -o bus.log           what candump writes and canplayer, Wireshark and python-can read
  leadscrew record --bus can0 -o setpoints.csv     setpoints, actual positions and events
  leadscrew record --bus can0 --params a.toml --further b.toml -o both.csv     of two boards
  leadscrew record --bus slcan:/dev/ttyACM0 -o bus.log --count 1000";

pub(super) const DOCTOR: &str = "\
Examples:
  leadscrew doctor --bus can0                      listen for ten seconds, read settings, name the first cause
  leadscrew doctor --bus can0 --listen-only --seconds 30
  leadscrew doctor --log bus.log --params lathe.toml      a log of `leadscrew record` or `candump -l`
  leadscrew doctor --rules                         all rules";

pub(super) const RUN: &str = "\
Examples:
  leadscrew run examples/shaft.nc
  leadscrew run part.nc --tolerance 1.0 --json
  leadscrew run part.nc --spindle-ripple 10@5 --tolerance 1.3
  leadscrew run part.nc --from 12 --bus can0      start at line 12, which has to be typed";

pub(super) const PARAMS: &str = "\
Examples:
  leadscrew params list thread                             all that have `thread` in their name or meaning
  leadscrew params get 1420.X --params lathe.toml          one value, and where it was set
  leadscrew params validate --params lathe.toml            find mistakes in a machine file
  leadscrew params docs > parameters.md                    the manual of all parameters
  leadscrew params pull -o lathe.toml --bus can0           a board's set as a file
  leadscrew params diff lathe.toml --bus can0              what pushing it would change
  leadscrew params push lathe.toml --bus can0              all of it, or nothing
  leadscrew params set 1420.X=11000 --bus can0             one value

A machine file is TOML, one value a line, keys by number or name, values with their unit:
  \"1420.X\" = \"12000 mm/min\"
  acceleration.Z = \"3 m/s²\"
  182.7 = 1";

pub(super) const PUSH: &str = "\
Examples:
  leadscrew params push lathe.toml --bus can0 --dry-run    what would change
  leadscrew params push lathe.toml --bus can0
  leadscrew params push lathe.toml --state board.flash     the simulated board's flash";

pub(super) const STATUS: &str = "\
Examples:
  leadscrew status --bus can0                    state, place, spindle, alarm, a tap in its hole
  leadscrew status --bus can0 --node 2 --json    for programs
  leadscrew status --state board.flash           what a simulated board has kept";

pub(super) const MONITOR: &str = "\
Examples:
  leadscrew monitor --bus can0             ? shows the keys, q ends it
  leadscrew monitor --bus can0 --watch     looks only";

pub(super) const PANEL: &str = "\
Examples:
  leadscrew panel --bus can0                          open a link that it prints
  leadscrew panel --bus can0 --programs parts         with the programs of this folder
  leadscrew panel --bus can0 --look                   nobody operates by it
  leadscrew panel --bus can0 --listen 127.0.0.1:0     at a port that is free
  leadscrew panel --bus can0 --host lathe.example     behind a proxy: https://lathe.example";

pub(super) const AGENT: &str = "\
Examples:
  leadscrew agent --bus can0 --broker mqtt://192.168.1.5 --machine lathe3
  leadscrew agent --bus can0 --broker mqtts://broker.example --ca shop.pem --login agent.login
  leadscrew agent --board lathe1=can0 --board lathe2=can1,node=2 --broker mqtt://192.168.1.5
  leadscrew agent --bus sim:desk --metrics 127.0.0.1:9464     figures alone; nothing is kept";

pub(super) const FLEET: &str = "\
Examples:
  leadscrew fleet list --broker mqtt://192.168.1.5
  leadscrew fleet diff machines --broker mqtt://192.168.1.5     machines/lathe3.toml against the set of lathe3, and so on";

pub(super) const FLEET_LIST: &str = "\
Examples:
  leadscrew fleet list --broker mqtt://192.168.1.5
  leadscrew fleet list --broker mqtts://broker.example --ca shop.pem --login fleet.login --group shop";

pub(super) const FLEET_DIFF: &str = "\
Examples:
  leadscrew fleet diff machines --broker mqtt://192.168.1.5
  leadscrew fleet diff machines --params common.toml --broker mqtt://192.168.1.5     each file over what all have";

pub(super) const HOLD: &str = "\
Example:
  leadscrew hold --bus can0     a stroke that cuts a thread is finished first";

pub(super) const RESUME: &str = "\
Example:
  leadscrew resume --bus can0     after a hold, M00 or M01
A held program whose axes were jogged: the first brings them back, the second goes on.";

pub(super) const HOME: &str = "\
Examples:
  leadscrew home --bus can0       all axes, in the order of 9059
  leadscrew home X --bus can0";

pub(super) const RESET: &str = "\
Example:
  leadscrew reset --bus can0     forgets the program, and leaves an alarm whose cause is gone";

pub(super) const STOP: &str = "\
Example:
  leadscrew stop --bus can0     all axes at once, alarm 4300; then `leadscrew reset`";

pub(super) const OVERRIDE: &str = "\
Examples:
  leadscrew override feed 80 --bus can0
  leadscrew override rapid 25 --bus can0
  leadscrew override spindle 110 --bus can0";

pub(super) const SIGNAL: &str = "\
Example:
  leadscrew signal G61.2=1 --bus can0     the next tap is left hand";

pub(super) const IO: &str = "\
Examples:
  leadscrew io list --bus can0
  leadscrew io set coolant=1 --bus can0
  leadscrew io wait input:3=1 --bus can0";

pub(super) const IO_LIST: &str = "\
Examples:
  leadscrew io list --bus can0                          by the names of leadscrew.toml
  leadscrew io list --params lathe.toml --bus sim:desk";

pub(super) const IO_SET: &str = "\
Examples:
  leadscrew io set coolant=1 --bus can0     the same as `mdi M8` where M8 sets it
  leadscrew io set output:2=0 --bus can0";

pub(super) const IO_WAIT: &str = "\
Example:
  leadscrew io wait door=1 --timeout 60 --bus can0     a minute at most";

pub(super) const LIST: &str = "\
Examples:
  leadscrew params list                        the built-in machine
  leadscrew params list thread --lang zh
  leadscrew params list --bus can0 --json      those of a board";

pub(super) const GET: &str = "\
Examples:
  leadscrew params get 1420.X
  leadscrew params get rapid_rate 182.7 --params lathe.toml";

pub(super) const VALIDATE: &str = "\
Examples:
  leadscrew params validate --params lathe.toml
  leadscrew params validate --params lathe.toml --set 1420.X=9000 --json";

pub(super) const DOCS: &str = "\
Examples:
  leadscrew params docs > parameters.md
  leadscrew params docs --eds > leadscrew.eds";

pub(super) const WRITE: &str = "\
Examples:
  leadscrew params set 1420.X=11000 --bus can0
  leadscrew params set rapid_rate.X=11m/min 182.7=1 --params lathe.toml
  leadscrew params set 9027=20 --state board.flash";

pub(super) const PULL: &str = "\
Examples:
  leadscrew params pull --bus can0 -o lathe.toml
  leadscrew params pull --bus can0 --into lathe.toml     keeps its comments";

pub(super) const RESTORE: &str = "\
Examples:
  leadscrew params restore --bus can0
  leadscrew params restore --bus can0 --dry-run     what would change";

pub(super) const DIFF: &str = "\
Examples:
  leadscrew params diff lathe.toml --bus can0     what pushing it would change
  leadscrew params diff old.toml new.toml
  leadscrew params diff --bus can0                a board against the built-in machine";

pub(super) const MIGRATE: &str = "\
Examples:
  leadscrew params migrate old.toml                what would change
  leadscrew params migrate old.toml -o new.toml";

pub(super) const TOOLS: &str = "\
Examples:
  leadscrew tools list --bus can0
  leadscrew tools set T1.radius=0.4 T1.tip=3 --bus can0
  leadscrew tools set T1.wear.X-=0.02 --bus can0     the part came out 0.02 too large
  leadscrew tools pull -o tools.toml --bus can0      to edit, and to push again
  leadscrew tools diff tools.toml --bus can0         what pushing it would change
  leadscrew tools push tools.toml --bus can0
  leadscrew check part.nc --tools tools.toml         without a board";

pub(super) const OFFSETS: &str = "\
Examples:
  leadscrew offsets list --bus can0
  leadscrew offsets set G54.Z=-400 --bus can0
  leadscrew offsets set shift.Z+=0.5 --bus can0";

pub(super) const TOUCH: &str = "\
Examples:
  leadscrew touch X --mark --bus can0               after a cut; then move off and measure
  leadscrew touch X 38.42 --tool 1 --bus can0       the diameter that was cut
  leadscrew touch Z 0 --tool 1 --bus can0           the tool stands at the face
  leadscrew touch Z 0 --work G54 --tool 1 --bus can0";

pub(super) const PICKUP: &str = "\
Examples:
  leadscrew pickup --tool 3 --bus can0              the tip of tool 3 sits in the groove, the spindle stands
  leadscrew check repair.nc --bus can0              tells at which angle its first thread begins
  leadscrew pickup --clear --bus can0               after the repair";

pub(super) const COMPLETIONS: &str = "\
Examples:
  leadscrew completions bash > ~/.local/share/bash-completion/completions/leadscrew
  leadscrew completions fish > ~/.config/fish/completions/leadscrew.fish";

pub(super) const MAN: &str = "\
Examples:
  leadscrew man run | man -l -
  leadscrew man --to ~/.local/share/man/man1";

pub(super) const UP: &str = "\
Examples:
  leadscrew up --machine examples/leadscrew.toml       a machine named desk, for the programs of examples
  export LEADSCREW_BUS=sim:desk                        which all commands of this terminal then mean
  leadscrew run examples/shaft.nc
  leadscrew monitor --bus sim:desk                     in another terminal
  leadscrew up --name big --machine big.toml           another one, with its own parameters
  leadscrew up --foreground                            its log in this terminal";

pub(super) const DOWN: &str = "\
Examples:
  leadscrew down
  leadscrew down --name big";

pub(super) const SIM: &str = "\
Examples:
  leadscrew sim estop press       alarm 4300; after its release `leadscrew reset`
  leadscrew sim power cycle       the board starts again with what its flash has kept
  leadscrew sim speed 0.1         a tenth of real time
  leadscrew sim state --name big";

pub(super) const SIM_DRIVE: &str = "\
Example:
  leadscrew sim drive Z fault       alarm 4357; after `sim drive Z well` a reset";

pub(super) const SIM_SPINDLE: &str = "\
Example:
  leadscrew sim spindle 60          alarm 4303 in a thread";

pub(super) const SIM_ENCODER: &str = "\
Example:
  leadscrew sim encoder no-index    alarm 4260 in a thread";

pub(super) const SIM_BUS: &str = "\
Example:
  leadscrew sim bus off             alarm 4370";

pub(super) const SIM_FLASH: &str = "\
Example:
  leadscrew sim flash worn          alarm 4343 where parameters are written";

pub(super) const SIM_DOOR: &str = "\
Example:
  leadscrew sim door open";

pub(super) const SIM_ESTOP: &str = "\
Examples:
  leadscrew sim estop press
  leadscrew sim estop release     then `leadscrew reset`";

pub(super) const SIM_HOLD: &str = "\
Examples:
  leadscrew sim hold press
  leadscrew sim hold release      then `leadscrew resume`";

pub(super) const SIM_INPUT: &str = "\
Examples:
  leadscrew sim input 3 off       until it is set otherwise
  leadscrew sim input 3 auto";

pub(super) const SIM_WHEEL: &str = "\
Examples:
  leadscrew sim input 6 on; leadscrew sim input 7 on     with 9048 = 5: Z, a detent is ten increments
  leadscrew sim wheel -250";

pub(super) const SIM_TURRET: &str = "\
Examples:
  leadscrew sim turret stuck     it does not turn: 4570 at the next T
  leadscrew sim turret well";

pub(super) const SIM_BLOCK: &str = "\
Examples:
  leadscrew sim block silent     4553, and both sides take the outputs of 9463
  leadscrew sim block well";

pub(super) const SIM_OUTPUTS: &str = "\
Example:
  leadscrew sim outputs";

pub(super) const SIM_POWER: &str = "\
Examples:
  leadscrew sim power cycle
  leadscrew sim power off         until `leadscrew sim power on`";

pub(super) const SIM_SPEED: &str = "\
Examples:
  leadscrew sim speed 0.1
  leadscrew sim speed 1";

pub(super) const SIM_STATE: &str = "\
Examples:
  leadscrew sim state
  leadscrew sim state --json";

pub(super) const MDI: &str = "\
Examples:
  leadscrew mdi \"T0101 M3 S600\"
  leadscrew mdi \"G98 G1 X38 Z-25 F100\"
  leadscrew mdi \"G53 G0 X-100; Z-50\"     two blocks
  leadscrew mdi                            asks for lines until Ctrl-D; arrow up brings the ones before";
