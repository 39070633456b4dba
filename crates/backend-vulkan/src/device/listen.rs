//! Routes validation messages to devices: devices share an instance, and each message is counted for the device
//! that it concerns.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use ash::vk;

use super::instance::Instance;

/// A Vulkan object: its type number and its handle.
pub(crate) type Object = (i32, u64);

/// The devices of an instance, and the messages about each.
#[derive(Debug, Default)]
pub(crate) struct Listeners {
    state: Mutex<State>,
}

#[derive(Debug, Default)]
struct State {
    opened: u64,
    live: BTreeMap<u64, Ledger>,
    /// Messages received while there was no device: counted for the next one.
    unclaimed: Vec<String>,
}

/// The objects of a device, and the messages about it.
#[derive(Debug, Default)]
struct Ledger {
    objects: BTreeSet<Object>,
    messages: Vec<String>,
}

impl Listeners {
    /// Registers a device that is about to be opened.
    fn open(&self) -> u64 {
        let mut state = self.state();
        state.opened += 1;
        let (id, messages) = (state.opened, std::mem::take(&mut state.unclaimed));
        state.live.insert(id, Ledger { messages, ..Ledger::default() });
        id
    }

    /// Registers an object of the given device.
    fn own(&self, id: u64, object: Object) {
        let mut state = self.state();
        // Handles of these types are addresses: a reused one belongs to the newer device only. Of the other
        // types, two devices may have equal handles.
        let address =
            [vk::ObjectType::DEVICE, vk::ObjectType::QUEUE, vk::ObjectType::COMMAND_BUFFER].map(vk::ObjectType::as_raw);
        if address.contains(&object.0) {
            for ledger in state.live.values_mut() {
                ledger.objects.remove(&object);
            }
        }
        if let Some(ledger) = state.live.get_mut(&id) {
            ledger.objects.insert(object);
        }
    }

    /// Counts a message for each device that owns one of its objects. A message that names no object of any
    /// device is counted for all devices, so that none is lost.
    pub(crate) fn hear(&self, objects: &[Object], text: &str) {
        let mut state = self.state();
        if state.live.is_empty() {
            state.unclaimed.push(text.to_owned());
            return;
        }
        let owns = |ledger: &Ledger| objects.iter().any(|object| ledger.objects.contains(object));
        let known = state.live.values().any(owns);
        for ledger in state.live.values_mut().filter(|ledger| !known || owns(ledger)) {
            ledger.messages.push(text.to_owned());
        }
    }

    fn messages(&self, id: u64) -> Vec<String> {
        self.state().live.get(&id).map(|ledger| ledger.messages.clone()).unwrap_or_default()
    }

    fn take(&self, id: u64) -> Vec<String> {
        self.state().live.get_mut(&id).map(|ledger| std::mem::take(&mut ledger.messages)).unwrap_or_default()
    }

    fn close(&self, id: u64) {
        self.state().live.remove(&id);
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Registration of one device with the listeners of its instance, from before the device is opened until after
/// it is destroyed.
pub(crate) struct Listener {
    instance: Arc<Instance>,
    id: u64,
}

impl Listener {
    pub(crate) fn new(instance: &Arc<Instance>) -> Self {
        Self { instance: Arc::clone(instance), id: instance.listeners.open() }
    }

    /// From now on, messages about this object are counted for this device.
    pub(crate) fn own<T: vk::Handle>(&self, handle: T) {
        self.instance.listeners.own(self.id, (T::TYPE.as_raw(), handle.as_raw()));
    }

    /// The messages about this device so far.
    pub(crate) fn messages(&self) -> Vec<String> {
        self.instance.listeners.messages(self.id)
    }

    /// Returns and clears the messages about this device.
    pub(crate) fn take(&self) -> Vec<String> {
        self.instance.listeners.take(self.id)
    }
}

impl Drop for Listener {
    fn drop(&mut self) {
        self.instance.listeners.close(self.id);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BUFFER: i32 = vk::ObjectType::BUFFER.as_raw();
    const COMMANDS: i32 = vk::ObjectType::COMMAND_BUFFER.as_raw();
    const INSTANCE: i32 = vk::ObjectType::INSTANCE.as_raw();

    #[test]
    fn a_message_counts_for_the_owner_of_any_of_its_objects() {
        let all = Listeners::default();
        let [a, b] = [all.open(), all.open()];
        all.own(a, (COMMANDS, 1));
        all.own(b, (COMMANDS, 2));
        all.own(b, (BUFFER, 1));
        all.hear(&[(INSTANCE, 9), (COMMANDS, 1)], "of a");
        all.hear(&[(BUFFER, 1)], "of b");
        all.hear(&[(COMMANDS, 1), (BUFFER, 1)], "of both");
        assert_eq!(all.messages(a), ["of a", "of both"]);
        assert_eq!(all.messages(b), ["of b", "of both"]);
        assert_eq!(all.take(a).len(), 2);
        assert!(all.messages(a).is_empty() && all.messages(b).len() == 2);
    }

    #[test]
    fn a_message_about_no_device_counts_for_all() {
        let all = Listeners::default();
        all.hear(&[], "before any");
        let a = all.open();
        let b = all.open();
        all.hear(&[(INSTANCE, 9)], "of the instance");
        all.close(b);
        // An object of a destroyed device.
        all.own(b, (BUFFER, 1));
        all.hear(&[(BUFFER, 1)], "of nobody");
        assert_eq!(all.messages(a), ["before any", "of the instance", "of nobody"]);
        assert!(all.messages(b).is_empty());
        all.close(a);
        all.hear(&[], "after all");
        assert_eq!(all.messages(all.open()), ["after all"]);
    }

    /// Freed command buffers are reused at the same address; handles of buffers are numbered by the driver.
    #[test]
    fn a_handle_that_is_used_again_is_the_later_devices() {
        let all = Listeners::default();
        let [a, b] = [all.open(), all.open()];
        for id in [a, b] {
            all.own(id, (COMMANDS, 1));
            all.own(id, (BUFFER, 1));
        }
        all.hear(&[(COMMANDS, 1)], "of b");
        all.hear(&[(BUFFER, 1)], "of either");
        assert_eq!(all.messages(a), ["of either"]);
        assert_eq!(all.messages(b), ["of b", "of either"]);
    }
}
