//! What a process has held at most, as the system counts it.
//!
//! Linux says so in `/proc/self/status`. Its `getrusage` does not: that figure outlives the start
//! of another program, so that a harness which holds much would lend its own peak to a small render.

use serde::Serialize;

/// Memory of this process.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Memory {
    /// Bytes of physical memory that the process has held at most so far, pages of its program and
    /// libraries included, to some 100 KiB; `None` where the system does not tell (all but Linux).
    pub peak_resident_bytes: Option<u64>,
}

impl Memory {
    /// Of this process until now.
    pub fn so_far() -> Self {
        let status = std::fs::read_to_string("/proc/self/status").ok();
        Self { peak_resident_bytes: status.as_deref().and_then(peak) }
    }
}

/// The high-water mark of a status file, whose "kB" are 1024 bytes (proc_pid_status(5)).
fn peak(status: &str) -> Option<u64> {
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: u64 = line.trim().strip_suffix(" kB")?.parse().ok()?;
    kibibytes.checked_mul(1 << 10)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_status_file_is_understood() {
        assert_eq!(peak("Name:\tetalon\nVmHWM:\t    1234 kB\nVmRSS:\t 1000 kB\n"), Some(1234 << 10));
        for strange in ["", "VmRSS:\t 1000 kB", "VmHWM:\t many kB", "VmHWM:\t 18446744073709551615 kB"] {
            assert_eq!(peak(strange), None, "{strange}");
        }
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn what_is_held_is_in_the_peak_and_stays_in_it() {
        const HELD: usize = 64 << 20;
        let peak = || Memory::so_far().peak_resident_bytes.expect("Linux tells");
        let before = peak();
        drop(std::hint::black_box(vec![1_u8; HELD]));
        let after = peak();
        assert!(after >= HELD as u64 && after >= before, "{before} bytes, then {after}");
    }
}
