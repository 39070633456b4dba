//! Load of the machine by other programs, to distinguish a disturbed measurement from a
//! slow one.

/// Linux reports processor time to user programs in hundredths of a second.
const TICKS_PER_SECOND: f64 = 100.0;

/// Processor time spent so far, in ticks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Load {
    /// By everything on the machine, including time stolen by a hypervisor.
    all: f64,
    /// By this process.
    own: f64,
    cores: f64,
}

impl Load {
    /// The current state; `None` where there is no `/proc`.
    #[must_use]
    pub fn now() -> Option<Self> {
        let machine = std::fs::read_to_string("/proc/stat").ok()?;
        let own = std::fs::read_to_string("/proc/self/stat").ok()?;
        Self::parse(&machine, &own)
    }

    fn parse(machine: &str, own: &str) -> Option<Self> {
        let cores = machine.lines().filter(|line| line.starts_with("cpu")).count().checked_sub(1)?;
        let numbers: Vec<f64> =
            machine.lines().next()?.split_whitespace().skip(1).map_while(|number| number.parse().ok()).collect();
        let &[user, nice, system, _idle, _wait, interrupts, soft, stolen, ..] = numbers.as_slice() else {
            return None;
        };
        // The name in parentheses may contain spaces; the fourteenth field is counted from after it.
        let mut fields = own.rsplit_once(')')?.1.split_whitespace().skip(11);
        let mut next = || fields.next()?.parse::<f64>().ok();
        Some(Self {
            all: user + nice + system + interrupts + soft + stolen,
            own: next()? + next()?,
            cores: cores as f64,
        })
    }

    /// The fraction of the machine, from 0 to about 1, that others used in the last `seconds`.
    #[must_use]
    pub fn others(&self, seconds: f64) -> Option<f64> {
        Some(self.others_until(&Self::now()?, seconds))
    }

    fn others_until(&self, later: &Self, seconds: f64) -> f64 {
        let ticks = (later.all - self.all) - (later.own - self.own);
        (ticks / (seconds * TICKS_PER_SECOND * self.cores)).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_others_took() {
        let machine = |user: u32| format!("cpu {user} 0 10 900 5 1 2 3 0 0\ncpu0 1 2\ncpu1 1 2\nintr 7\n");
        let own = |user: u32| format!("7 (a b) c) R 1 2 3 4 5 6 7 8 9 10 {user} 20 0 0\n");
        let before = Load::parse(&machine(100), &own(50)).unwrap();
        assert_eq!(before, Load { all: 116.0, own: 70.0, cores: 2.0 });
        // 150 ticks on the machine, 110 of them our own: 40 of 200.
        let after = Load::parse(&machine(250), &own(160)).unwrap();
        assert!((before.others_until(&after, 1.0) - 0.2).abs() < 1e-12);
        assert!(Load::parse("cpu 1 2", &own(1)).is_none());
        assert!(Load::parse(&machine(1), "7 (a) R 1").is_none());
    }
}
