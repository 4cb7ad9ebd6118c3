//! Generates docs/errors.md: every code with its cause and remedy, and the reaction of an axis to an error.

use lineshaft_core::axis::stops_all;
use lineshaft_core::code::{Code, DRIVE_FAULT, Row};
use std::fmt::Write;

const INTRODUCTION: &str = "\
# Codes

The tables of this page are those of the program. `LINESHAFT_RENEW=1 cargo test -p lineshaft --lib errors`
regenerates the page.

A code is in `x.error`, in `error_code` of ~/axis_states, in events, and in the result of an action:

- 0: no error
- below 1000: error numbers of MACS
- from 1000: alarms of the WF modules (1000 + number)
- from 2000: the SAIA module
- from 3000: function slots
- from 10000: Lineshaft
- from 65536 (10000h): faults that a drive reports (10000h + its object 603Fh)

## What an error does

Every axis is checked in every cycle. An error is reported in the cycle in which it is found, and the reaction
begins in that cycle.

- `x.error` has the first error of an axis until the reset. The signals `x.fault.code`, `.cycle`, `.command`,
  `.velocity`, `.actual` and `.following_error` have the state of the axis at that time, until the next error.
- A further error before the reset is reported as an event.
- A drive that fails while its axis is off stops nothing. A warning with its code is reported, at most once a
  second, and the next enable ends in the error.
- `~/errors` has the last 32 errors and resets, with the remedy; a client that subscribes later gets them too.
  /diagnostics has the cause, the remedy and the state of the axis at that time.
- A line of the log and of `/rosout` at ERROR or WARN about an event ends with the code and the remedy:
  `x: (message) (10205). (remedy)`.

Parameter `error_reaction` selects the reaction:

| `error_reaction` (ERRCOND) | the axis |
|-|-|
| 0 | coasts: no voltage |
| 1 | coasts, and its brake closes at once |
| 2 | stops with `max_deceleration`, and holds |
| 3 | stops with `max_deceleration`; then its brake closes |
| 4 | is left to the quick stop of its drive |
| 5 | goes on; the error is reported, a following error again every second while it lasts |

If a following error was reported with 5, and it lasts or occurs again after another value was set, the
reaction is that of the new value. With 1 and 3 the brake that `o_brake` names also closes where a fault
removes the power at once.

The reaction to a code follows from its text in column *reaction* of the tables below, which begins with the
text given here, and from `error_reaction` (for a skew from `skew_reaction`):

| reaction | where | 0 | 1 | 2 | 3 | 4 | 5 |
|-|-|-|-|-|-|-|-|
| as `error_reaction` says | | off | off + brake | hold | hold + brake | drive | go on |
| as `error_reaction` says; 5 stops as 2 | | off | off + brake | hold | hold + brake | drive | hold |
| where it ends a homing or a search | | off | off + brake | hold | hold + brake | drive | end |
| `endswmod` 1: stop and hold | `endswmod` 0 | off | off + brake | hold | hold + brake | drive | hold |
| `endswmod` 1: stop and hold | `endswmod` 1 | hold | hold | hold | hold | hold | hold |
| as `skew_reaction` says | | off | off + brake | hold | hold + brake | drive | go on |
| stops at the limit | | stop, off | stop, off + brake | hold | hold + brake | stop, drive | hold |
| drive off where the position loop is closed here | loop closed here | off | off + brake | off + brake | off + brake | off + brake | off + brake |
| drive off where the position loop is closed here | loop in the drive | off | off + brake | hold | hold + brake | drive | hold |
| drive off | | off | off + brake | off | off + brake | off | off |
| stop with `max_deceleration`, then hold | | hold | hold | hold | hold + brake | hold | hold |
| stop with `max_deceleration`, then drive off and brake closed | | stop, off + brake | stop, off + brake | stop, off + brake | stop, off + brake | stop, off + brake | stop, off + brake |
| none; with `saia.command_error` motor_off | | off | off + brake | off | off + brake | off | off |

The next table explains the words of the last one. *Brake* is the brake of `o_brake`. A brake of section
`brake` closes whenever nothing else holds the axis.

| word | in the cycle of the error | once it stands | locked |
|-|-|-|-|
| off | no power | no power | yes |
| off + brake | no power, brake | no power, brake | yes |
| hold | stops | power | yes |
| hold + brake | stops | power, brake | yes |
| stop, off | stops | no power | yes |
| stop, off + brake | stops | no power, brake | yes |
| drive | quick stop | quick stop | yes |
| stop, drive | stops | quick stop | yes |
| end | stops | power | no |
| go on | goes on | goes on | no |

- *Stops*: with `max_deceleration`; at a software limit so that the axis ends there. With interface open_loop
  the speed is 0, and the axis coasts under power.
- *Locked*: the state is ERROR_STOP. Enable and every motion are refused until the reset.
- A virtual axis has no power: it stops instead of losing it, and a brake that it has closes at standstill.
- The error output `o_error` is on with all of them until the reset.

If column *reaction* of a code is empty, the code is no error of an axis, but a refusal, the end of a goal, a
warning or a notice. One exception: with `saia.command_error` motor_off every refusal of a command of `saia`
switches the drive off as an error, also with a code of Lineshaft.

With `following_error_stops_all: 1` a following error of the axis stops all axes with a drive, each by its own
`error_reaction`, as in MACS (MACS-ERR-05).

## Reset

`~/reset_errors` waits until the axis is at rest, resets the fault of the drive and clears the error.

- Bit 7 of the control word is 1 and 0 in turn, each for at least 50 ms and five cycles, because some drives
  read it seldom.
- An error whose cause persists returns, and the reset ends with its code: at once with an open contact or a
  following error, after 5 s with a drive that does not leave its fault.
- Without power the axis is at rest when its encoder has moved by at most 2 counts, or at most 0.1 % of
  `max_velocity`, for 5 ms. The reset waits up to 5 s for that, and not at all if the drive is lost.
- A brake that the error has closed under power opens with the reset, which ends when the axis accepts goals.
  If the brake held a following error, the axis begins at its actual position.

A reaction that first stops the axis and then removes its power or closes its brake waits in the same way:
until the axis itself is at rest, not only its command. It waits up to 5 s, and not if the axis moves away
from its command by more than `max_following_error`.

## Limit switches

A limit switch is a bit of the drive (60FDh) or the input that `i_poslimitsw` or `i_neglimitsw` assigns. The
positive one is at the end of rising counts.

- Its edge stops the axis, also an axis at rest, but not one that moves away from the switch.
- Its level blocks every motion towards the switch, also after power-on. A motion known beforehand is refused
  with 98; a coupling that leads there is stopped with 98. After the reset the axis can move away.
- With `endswmod` 1 the axis stops with `max_deceleration` and holds. With 0 the reaction is that of
  `error_reaction`, where 5 stops as 2 does.
- With `endswmod` 0 (the default) and `error_reaction` 0 or 1 the axis coasts past the switch: set
  `endswmod: 1` or `error_reaction: 2`.
- While an axis homes, its switches belong to homing.

## Contacts of the cell

```yaml
safety: {estop: estop_ok, interlock: door_closed} # entries of io, type di, that read 1 in the good state
```

A contact that reads 0, also because its wire is broken, stops all axes in that cycle.

- `estop`: the axes stop with `max_deceleration`. Then their brakes close and their power is removed, on an
  axis with a section `brake` after its `engage_delay`.
- `interlock`: the axes stop and hold.

While a contact is open nothing can be enabled or moved. A start of `saia`, which would switch the drive on,
is a command error. The reference selector of a virtual axis at rest, which gets no error by it, is set back
to 0. Closing the contact resets nothing.

**This is no safety function:** the contacts must act on the power of the drives as well (safe torque off).
";

/// Ranges of codes with their headings.
const PARTS: [(&str, u32, u32); 7] = [
    ("MACS", 1, 999),
    ("Siemens WF 725", 1000, 1999),
    ("SAIA PCD4.H3", 2000, 2999),
    ("AMKASYN fast functions", 3000, 3999),
    ("Lineshaft: refused", 10_000, 10_100),
    ("Lineshaft: ended", 10_101, 10_199),
    ("Lineshaft: failed", 10_200, 65_535),
];

/// Returns the heading of the table of a code; empty for 0, which is no code.
pub(crate) fn part(code: Code) -> &'static str {
    let is_in = |(_, low, high): &&(&str, u32, u32)| (*low..=*high).contains(&code.0);
    if code.is_none() { "" } else { PARTS.iter().find(is_in).map_or("Drives", |(name, ..)| *name) }
}

/// Returns the content of the page.
pub fn markdown() -> String {
    let mut page = INTRODUCTION.to_owned();
    for (name, low, high) in PARTS {
        // Writing to a string cannot fail.
        let _ = write!(page, "\n## {name}\n\n| code | name | cause | remedy | reaction |\n|-|-|-|-|-|\n");
        let mut rows: Vec<_> = Code::rows().filter(|row| (low..=high).contains(&row.code.0)).collect();
        rows.sort_unstable_by_key(|row| row.code);
        rows.into_iter().for_each(|row| page.push_str(&line(row)));
    }
    let Row { cause, remedy, class, .. } = DRIVE_FAULT;
    let reaction = class.text();
    let _ = write!(page, "\n## Drives\n\n| code | cause | remedy | reaction |\n|-|-|-|-|\n");
    let _ = writeln!(page, "| 65536 + 603Fh | {cause} | {remedy} | {reaction} |");
    page
}

fn line(row: &Row) -> String {
    let Row { code, name, class, cause, remedy, .. } = row;
    let mut reaction = class.text().to_owned();
    if stops_all(*code) {
        reaction.push_str("; with `following_error_stops_all` all axes");
    }
    format!("| {} | {name} | {cause} | {remedy} | {reaction} |\n", code.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// docs/errors.md must be the generated page.
    #[test]
    fn the_page_in_docs_is_the_one_that_the_program_makes() {
        crate::page::check("errors.md", "errors", |_| markdown());
    }

    #[test]
    fn every_code_has_one_line_with_a_cause() {
        let page = markdown();
        for Row { name, code, .. } in Code::rows().filter(|row| !row.code.is_none()) {
            let start = format!("| {} | {name} | ", code.0);
            let lines: Vec<_> = page.lines().filter(|line| line.starts_with(&start)).collect();
            assert_eq!(lines.len(), 1, "{name}");
            let cells: Vec<_> = lines[0].split(" | ").collect();
            assert!(cells.len() == 5 && !cells[2].is_empty() && !cells[3].is_empty(), "{}", lines[0]);
        }
    }

    /// The page has a reaction for every code that is an error of an axis, and for no other one.
    #[test]
    fn page_shows_reactions_only_of_errors() {
        let page = markdown();
        let reaction = |number: u32| {
            let start = format!("| {number} | ");
            let line = page.lines().find(|line| line.starts_with(&start)).unwrap();
            line.rsplit('|').nth(1).unwrap().trim().to_owned()
        };
        for number in [6, 1101, 10_001, 10_101, 10_209, 10_213, 10_227, 10_228, 10_301, 10_321, 10_327, 10_341, 10_356]
        {
            assert_eq!(reaction(number), "", "{number}");
        }
        for number in [10_306, 10_307, 10_308, 10_310, 10_311, 10_313] {
            assert!(
                reaction(number).starts_with("where it ends a homing or a search: as `error_reaction`"),
                "{number}"
            );
        }
        assert_eq!(reaction(88), "drive off");
        assert_eq!(reaction(1010), "as `error_reaction` says");
        assert!(reaction(10_201).starts_with("as `error_reaction` says; with `following_error_stops_all`"));
        assert!(reaction(10_225).starts_with("stop with `max_deceleration`, then drive off"));
    }
}
