//! Masters that combine several leaders, and the leader relations of axes.
//!
//! Law      the members of a master are simple leaders and other masters; it adds up the simple ones of all of them
//! Refuses  a master without members, members that do not exist or are listed twice, masters that read each other in a
//!          loop, more members than there is room for; axes whose selectors would follow themselves
//! Source   contract section 10, PLCopen (MC_CombineAxes)

use super::{ConfigError, MachineConfig, SourceConfig};
use crate::object::{AxisSet, Leader};
use crate::sync::{MOST_TERMS, Sum};

/// Prefix of the names of signals of the virtual master.
const OF_VIRTUAL: &str = "machine.vmaster.";

/// Maximum entries of `masters`.
pub const MAX_MASTERS: usize = 64;
/// Maximum members per entry.
pub const MAX_MEMBERS: usize = 16;

/// An entry of `masters`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SumConfig {
    /// Name.
    pub name: String,
    /// Members that are added.
    pub add: Vec<Leader>,
    /// Members that are subtracted.
    pub subtract: Vec<Leader>,
}

impl SumConfig {
    /// Returns the members, added ones first; true for those that are added.
    pub fn members(&self) -> impl Iterator<Item = (Leader, bool)> {
        let added = self.add.iter().map(|member| (*member, true));
        added.chain(self.subtract.iter().map(|member| (*member, false)))
    }
}

/// Error of a master.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SumProblem {
    /// No members.
    #[error("it adds up nothing")]
    Empty,
    /// Too many members.
    #[error("it has {0} members; at most {MAX_MEMBERS} are possible")]
    Members(usize),
    /// Too many simple leaders, including those of other masters.
    #[error("it has more than {MOST_TERMS} leaders, itself and through other masters")]
    Leaders,
    /// A member that does not exist, or that must not be followed.
    #[error("a member is nothing that it can follow")]
    Place,
    /// A member that is listed twice.
    #[error("a member stands in it twice")]
    Twice,
    /// A loop of masters.
    #[error("it is a member of itself, directly or through others")]
    Loop,
}

/// Returns the sums of the masters; `None` for a master in a loop, or with a member in a loop.
pub fn sums(masters: &[SumConfig]) -> Vec<Option<Sum>> {
    let mut sums: Vec<Option<Sum>> = vec![None; masters.len()];
    // Each pass resolves at least one more master, unless only loops are left.
    for _ in masters {
        for (place, master) in masters.iter().enumerate() {
            if sums.get(place).is_some_and(Option::is_none) {
                let sum = sum(master, &sums);
                if let Some(told) = sums.get_mut(place) {
                    *told = sum;
                }
            }
        }
    }
    sums
}

fn sum(master: &SumConfig, told: &[Option<Sum>]) -> Option<Sum> {
    master.members().try_fold(Sum::default(), |sum, (member, is_added)| match member {
        Leader::Sum(place) => Some(sum.with_sum(told.get(usize::from(place))?.as_ref()?, is_added)),
        simple => Some(sum.with(simple, is_added)),
    })
}

impl MachineConfig {
    /// Returns the sums of the masters.
    pub(crate) fn sums(&self) -> Vec<Sum> {
        sums(&self.masters).into_iter().map(Option::unwrap_or_default).collect()
    }

    /// Checks the masters.
    pub(super) fn check_sums(&self) -> Result<(), ConfigError> {
        for (master, sum) in self.masters.iter().zip(sums(&self.masters)) {
            self.check_sum(master, sum.as_ref())
                .map_err(|problem| ConfigError::Master { master: master.name.clone(), problem })?;
        }
        Ok(())
    }

    fn check_sum(&self, master: &SumConfig, sum: Option<&Sum>) -> Result<(), SumProblem> {
        let members: Vec<Leader> = master.members().map(|(member, _)| member).collect();
        if members.is_empty() {
            return Err(SumProblem::Empty);
        }
        if members.len() > MAX_MEMBERS {
            return Err(SumProblem::Members(members.len()));
        }
        if members.iter().any(|member| !self.is_leader(*member)) {
            return Err(SumProblem::Place);
        }
        if members.iter().zip(1..).any(|(member, behind)| members.iter().skip(behind).any(|other| other == member)) {
            return Err(SumProblem::Twice);
        }
        match sum {
            None => Err(SumProblem::Loop),
            Some(sum) if !sum.is_small() => Err(SumProblem::Leaders),
            Some(_) => Ok(()),
        }
    }

    /// Returns true if the leader exists and has a name.
    fn is_leader(&self, leader: Leader) -> bool {
        let (place, count) = match leader {
            Leader::AxisCommand(place) | Leader::AxisActual(place) => (place, self.axes.len()),
            Leader::Encoder(place) => (place, self.encoders.len()),
            Leader::Sink(place) => (place, self.slots.len()),
            Leader::Sum(place) => (place, self.masters.len()),
            Leader::Virtual => return true,
            Leader::Simulated(_) => return false,
        };
        usize::from(place) < count
    }

    /// Returns the axes whose commands a leader reads, directly or through sinks and other masters: they move before
    /// its followers, and must not follow them. The leader of the virtual master is not part of the cell.
    pub fn commanded_axes(&self, leader: Leader) -> AxisSet {
        let axis = |leader| if let Leader::AxisCommand(axis) = leader { Some(axis) } else { None };
        self.read_leaders(leader).into_iter().filter_map(axis).collect()
    }

    /// Returns true if a leader reads the virtual master, directly or through sinks and other masters.
    pub(crate) fn reads_virtual(&self, leader: Leader) -> bool {
        self.read_leaders(leader).contains(&Leader::Virtual)
    }

    /// Returns a leader and those that it reads, directly or through sinks and other masters.
    fn read_leaders(&self, leader: Leader) -> Vec<Leader> {
        let (mut reached, mut next) = (vec![leader], 0);
        // Each leader is visited once, so that a loop ends, too.
        while let Some(leader) = reached.get(next).copied() {
            next += 1;
            let mut reach = |leader| {
                if !reached.contains(&leader) {
                    reached.push(leader);
                }
            };
            match leader {
                Leader::AxisCommand(_)
                | Leader::AxisActual(_)
                | Leader::Encoder(_)
                | Leader::Simulated(_)
                | Leader::Virtual => {}
                Leader::Sink(slot) => match self.slots.get(usize::from(slot)).map(|slot| &slot.source) {
                    Some(SourceConfig::Lead(source)) => reach(*source),
                    Some(SourceConfig::Signal(name)) if name.starts_with(OF_VIRTUAL) => reach(Leader::Virtual),
                    _ => {}
                },
                Leader::Sum(place) => {
                    let members = self.masters.get(usize::from(place)).into_iter().flat_map(SumConfig::members);
                    members.for_each(|(member, _)| reach(member));
                }
            }
        }
        reached
    }

    /// A vocabulary may couple its axis at any time: a chain of masters must not be a loop.
    pub(super) fn check_masters(&self) -> Result<(), ConfigError> {
        let master = |axis: &super::AxisConfig| axis.vocabularies.master().map(|leader| self.commanded_axes(leader));
        let leaders: Vec<AxisSet> = self.axes.iter().map(|axis| master(axis).unwrap_or_default()).collect();
        for (index, axis) in self.axes.iter().enumerate() {
            let mut reached = leaders.get(index).copied().unwrap_or_default();
            let mut next = reached;
            while let Some(leader) = next.pop() {
                let leaders = leaders.get(usize::from(leader)).copied().unwrap_or_default();
                next = next.union(&leaders.difference(&reached));
                reached = reached.union(&leaders);
            }
            if reached.contains(index as u16) {
                return Err(ConfigError::MasterLoop { axis: axis.name.clone() });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::SlotConfig;
    use crate::function::Kind;
    use crate::machine::rig::{LINE, X, Y, config};
    use crate::unit::Scale;

    const BELT: Leader = Leader::Encoder(0);

    fn master(add: &[Leader], subtract: &[Leader]) -> SumConfig {
        SumConfig { name: "sum".to_owned(), add: add.to_vec(), subtract: subtract.to_vec() }
    }

    fn problem(masters: Vec<SumConfig>) -> Option<SumProblem> {
        match (MachineConfig { masters, ..config(0) }).check() {
            Ok(()) => None,
            Err(ConfigError::Master { problem, .. }) => Some(problem),
            Err(other) => panic!("{other}"),
        }
    }

    /// A sum has the common scale of its members.
    #[test]
    fn a_sum_has_the_scale_of_its_members() {
        let sum = Leader::Sum;
        let masters = vec![
            master(&[BELT, Leader::AxisActual(X)], &[Leader::AxisCommand(Y)]),
            master(&[sum(0)], &[Leader::AxisCommand(LINE)]),
            master(&[sum(0), BELT], &[]),
        ];
        let mut config = MachineConfig { masters, ..config(0) };
        let scale = config.axes[0].scale;
        assert_eq!([0, 1, 2].map(|place| config.scale_of(sum(place))), [scale; 3]);
        let per = crate::unit::Quantity::new(crate::unit::Fraction::from(1), crate::unit::Unit::METRE);
        config.axes[usize::from(LINE)].scale = Scale::new(crate::unit::Fraction::from(7), per).expect("a scale");
        assert_eq!([0, 1].map(|place| config.scale_of(sum(place))), [scale, Scale::increments()]);
        assert_eq!(config.scale_of(sum(9)), Scale::increments());
        // The config is not checked here: the search ends all the same.
        config.masters[0].add.push(sum(1));
        assert_eq!(config.scale_of(sum(1)), Scale::increments());
    }

    #[test]
    fn invalid_master_is_refused() {
        let sum = Leader::Sum;
        assert_eq!(problem(vec![master(&[BELT, Leader::AxisActual(X)], &[Leader::AxisCommand(Y)])]), None);
        assert_eq!(problem(vec![master(&[], &[BELT])]), None);
        assert_eq!(problem(vec![master(&[], &[])]), Some(SumProblem::Empty));
        for nothing in [
            Leader::Encoder(1),
            Leader::AxisActual(3),
            Leader::AxisCommand(3),
            Leader::Sink(0),
            sum(1),
            Leader::Simulated(X),
        ] {
            assert_eq!(problem(vec![master(&[BELT, nothing], &[])]), Some(SumProblem::Place), "{nothing:?}");
        }
        assert_eq!(problem(vec![master(&[BELT, BELT], &[])]), Some(SumProblem::Twice));
        assert_eq!(problem(vec![master(&[BELT], &[BELT])]), Some(SumProblem::Twice));
        assert_eq!(problem(vec![master(&[sum(0)], &[])]), Some(SumProblem::Loop));
        assert_eq!(problem(vec![master(&[sum(1)], &[]), master(&[BELT], &[sum(0)])]), Some(SumProblem::Loop));
        // Masters may refer to each other in any order of the file.
        assert_eq!(problem(vec![master(&[sum(1)], &[]), master(&[sum(2)], &[]), master(&[BELT], &[])]), None);
    }

    /// The n-th master has 2^n leaders: 64 are the maximum.
    #[test]
    fn members_are_counted() {
        let doubles = |count: u16| -> Vec<SumConfig> {
            let pair = |nth: u16| match nth {
                0 => vec![BELT, Leader::AxisCommand(LINE)],
                1 => vec![Leader::Sum(0), Leader::AxisCommand(X), Leader::AxisActual(X)],
                nth => vec![Leader::Sum(nth - 1), Leader::Sum(nth - 2)],
            };
            (0..count).map(|nth| master(&pair(nth), &[])).collect()
        };
        // 2, 4, 6, 10, 16, 26, 42, 68.
        assert_eq!(problem(doubles(7)), None);
        assert_eq!(problem(doubles(8)), Some(SumProblem::Leaders));
        let many = |count: u16| {
            let axes = MachineConfig { axes: config(0).axes.into_iter().cycle().take(20).collect(), ..config(0) };
            let masters = vec![master(&(0..count).map(Leader::AxisActual).collect::<Vec<_>>(), &[])];
            MachineConfig { masters, ..axes }.check().map_err(|error| error.to_string())
        };
        assert_eq!(many(16), Ok(()));
        assert_eq!(many(17), Err("sum: it has 17 members; at most 16 are possible".to_owned()));
        let most = |count| MachineConfig { masters: vec![master(&[BELT], &[]); count], ..config(0) }.check();
        assert_eq!(most(64), Ok(()));
        let many = ConfigError::TooMany { what: "masters", count: 65, most: 64 };
        assert_eq!(most(65), Err(many));
    }

    #[test]
    fn a_leader_reads_commands_through_sinks_and_masters() {
        let mut slot = SlotConfig::new("f".to_owned(), 0, Kind::Dcopy);
        slot.source = SourceConfig::Lead(Leader::Sum(0));
        let masters = vec![
            master(&[BELT, Leader::AxisCommand(X)], &[Leader::AxisActual(LINE)]),
            master(&[Leader::Sink(0)], &[Leader::AxisCommand(Y)]),
        ];
        let config = MachineConfig { slots: vec![slot], masters, ..config(0) };
        let through = |leader| config.commanded_axes(leader).iter().collect::<Vec<_>>();
        assert_eq!(through(Leader::Sum(0)), [X]);
        assert_eq!(through(Leader::Sink(0)), [X]);
        assert_eq!(through(Leader::Sum(1)), [X, Y]);
        assert_eq!([BELT, Leader::AxisActual(X), Leader::Sum(2)].map(through), [vec![], vec![], vec![]]);
    }
}
