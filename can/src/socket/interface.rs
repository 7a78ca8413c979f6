//! Checks an interface before a socket is bound to it. Without these checks a socket on an interface that is down would
//! only be silent.

use std::fs;
use std::path::Path;

use crate::CanError;

/// The kernel's list of interfaces.
const INTERFACES: &str = "/sys/class/net";

/// `ARPHRD_CAN`.
const CAN: &str = "280";

/// `IFF_UP`.
const UP: u32 = 1;

/// Refuses an interface that is no CAN interface or is down.
pub fn check(name: &str) -> Result<(), CanError> {
    look(Path::new(INTERFACES), name)
}

/// True for an interface without a controller of its own (vcan). If it is taken down, nobody except its user would
/// start it again.
#[must_use]
pub fn is_virtual(name: &str) -> bool {
    lies_with_virtual_ones(Path::new(INTERFACES), name)
}

fn lies_with_virtual_ones(all: &Path, name: &str) -> bool {
    // The entries of the list are links to the devices.
    fs::canonicalize(all.join(name)).is_ok_and(|device| {
        device
            .components()
            .any(|part| part.as_os_str() == "virtual")
    })
}

/// MTU of an interface that carries only classical frames.
const CLASSICAL_ONLY: &str = "16";

/// Refuses an interface without FD frames.
pub fn check_fd(name: &str) -> Result<(), CanError> {
    look_for_fd(Path::new(INTERFACES), name)
}

fn look_for_fd(all: &Path, name: &str) -> Result<(), CanError> {
    match fs::read_to_string(all.join(name).join("mtu")) {
        Ok(mtu) if mtu.trim() == CLASSICAL_ONLY => Err(CanError::NoFd { name: name.into() }),
        // Without a list the socket itself reports the error.
        _ => Ok(()),
    }
}

fn look(all: &Path, name: &str) -> Result<(), CanError> {
    if !all.is_dir() {
        // Without the list the socket itself reports the error.
        return Ok(());
    }
    let of = |name: &str, what: &str| {
        fs::read_to_string(all.join(name).join(what)).map(|text| text.trim().to_owned())
    };
    if !all.join(name).exists() {
        let mut known: Vec<String> = fs::read_dir(all)
            .into_iter()
            .flatten()
            .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
            .filter(|name| of(name, "type").is_ok_and(|kind| kind == CAN))
            .collect();
        known.sort();
        return Err(CanError::NoInterface {
            name: name.into(),
            known,
        });
    }
    if of(name, "type").is_ok_and(|kind| kind != CAN) {
        return Err(CanError::NotCan { name: name.into() });
    }
    let flags = of(name, "flags")
        .ok()
        .and_then(|text| u32::from_str_radix(text.trim_start_matches("0x"), 16).ok());
    match flags {
        Some(flags) if flags & UP == 0 => Err(CanError::Down { name: name.into() }),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A list of interfaces as the kernel writes it.
    fn with(test: &str, interfaces: &[(&str, &str, &str)], name: &str) -> String {
        let all = std::env::temp_dir().join(format!("leadscrew-{test}-{}", std::process::id()));
        for (name, kind, flags) in interfaces {
            let dir = all.join(name);
            fs::create_dir_all(&dir).unwrap();
            fs::write(dir.join("type"), format!("{kind}\n")).unwrap();
            fs::write(dir.join("flags"), format!("{flags}\n")).unwrap();
        }
        let result = look(&all, name);
        fs::remove_dir_all(&all).unwrap();
        match result {
            Ok(()) => "ok".into(),
            Err(error) => error.to_string(),
        }
    }

    #[test]
    fn an_interface_for_classical_frames_is_told_from_one_for_fd() {
        let all = std::env::temp_dir().join(format!("leadscrew-mtu-{}", std::process::id()));
        for (name, mtu) in [("can0", "16\n"), ("can1", "72\n")] {
            fs::create_dir_all(all.join(name)).unwrap();
            fs::write(all.join(name).join("mtu"), mtu).unwrap();
        }
        let said = ["can0", "can1", "can2"].map(|name| look_for_fd(&all, name));
        fs::remove_dir_all(&all).unwrap();
        let [classical, fd, none] = said;
        let text = classical.unwrap_err().to_string();
        assert!(
            text.contains("`can0` carries classical frames only"),
            "{text}"
        );
        assert!(
            text.contains("dbitrate") && text.contains("mtu 72"),
            "{text}"
        );
        assert!(fd.is_ok() && none.is_ok());
    }

    #[cfg(unix)]
    #[test]
    fn an_interface_without_a_controller_is_told_from_one_with() {
        let all = std::env::temp_dir().join(format!("leadscrew-virtual-{}", std::process::id()));
        for (name, device) in [
            ("vcan0", "devices/virtual/net/vcan0"),
            ("can0", "devices/pci0/usb1/net/can0"),
        ] {
            fs::create_dir_all(all.join(device)).unwrap();
            std::os::unix::fs::symlink(all.join(device), all.join(name)).unwrap();
        }
        let said = ["vcan0", "can0", "can7"].map(|name| lies_with_virtual_ones(&all, name));
        fs::remove_dir_all(&all).unwrap();
        assert_eq!(said, [true, false, false]);
    }

    #[test]
    fn each_mistake_has_its_own_words() {
        let all = [
            ("can0", "280", "0x40080"),
            ("vcan1", "280", "0x400c1"),
            ("vcan0", "280", "0x400c1"),
            ("lo", "772", "0x9"),
        ];
        assert_eq!(with("up", &all, "vcan0"), "ok");
        let missing = with("missing", &all, "vcan7");
        assert!(
            missing.contains("`vcan7`; the CAN interfaces here are can0, vcan0, vcan1"),
            "{missing}"
        );
        let none = with("none", &all[3..], "can0");
        assert!(none.contains("nor any other"), "{none}");
        let other = with("other", &all, "lo");
        assert!(other.contains("not one of CAN"), "{other}");
        let down = with("down", &all, "can0");
        assert!(down.contains("ip link set can0 up"), "{down}");
    }
}
