//! The condition under which a pass is abandoned while its stages work.

use std::fmt;
use std::sync::Arc;
use std::time::Instant;

use crate::error::{Error, Result};

/// A condition under which a pass that has begun is abandoned. Most stages test it on any of their threads, every few
/// milliseconds; once it is met, it must stay so until the pass has ended.
#[derive(Clone)]
pub struct StopCondition(Arc<dyn Fn() -> bool + Send + Sync>);

impl StopCondition {
    /// A condition that is met when the function returns true.
    #[must_use]
    pub fn new(condition: impl Fn() -> bool + Send + Sync + 'static) -> Self {
        Self(Arc::new(condition))
    }

    /// A condition that is met from an instant on.
    #[must_use]
    pub fn at(instant: Instant) -> Self {
        Self::new(move || Instant::now() >= instant)
    }

    /// A condition that is met when this one or another is.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        Self::new(move || self.is_met() || other.is_met())
    }

    /// Whether it is met now.
    #[must_use]
    pub fn is_met(&self) -> bool {
        (self.0)()
    }

    /// The error with which stages end once it is met.
    ///
    /// # Errors
    /// [`Error::Cancelled`] if it is.
    pub fn check(&self) -> Result<()> {
        if self.is_met() { Err(Error::Cancelled) } else { Ok(()) }
    }
}

impl fmt::Debug for StopCondition {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_tuple("StopCondition").field(&self.is_met()).finish()
    }
}
