//! The messages of this crate in Chinese: errors of a bus, and its probable faults.

use crate::{CanError, Suspicion};

impl CanError {
    /// In Chinese; [`Display`](std::fmt::Display) is the English text.
    #[must_use]
    pub fn chinese(&self) -> String {
        match self {
            Self::NotABus => "`sim` 在模拟它的进程之内；请指定真实总线，例如 `--bus can0`".into(),
            Self::NoCan => "内核不支持 CAN：请执行 `modprobe can can_raw vcan`，或换用支持 CAN 的内核（docs/can.md）".into(),
            Self::NoInterface { name, known } if known.is_empty() => format!(
                "没有接口 `{name}`，也没有任何其它 CAN 接口；可建立虚拟接口：`ip link add dev vcan0 type vcan && ip link set \
                 vcan0 up`（docs/can.md）"
            ),
            Self::NoInterface { name, known } => {
                format!("没有接口 `{name}`；现有的 CAN 接口：{}", known.join("、"))
            }
            Self::NotCan { name } => {
                format!("`{name}` 是接口，但不是 CAN 接口；`ip -details link show type can` 可列出 CAN 接口")
            }
            Self::NoFd { name } => format!(
                "接口 `{name}` 只支持经典帧。请在接口停用时执行：虚拟接口 `ip link set {name} mtu 72`；支持 FD 的真实接口 `ip link \
                 set {name} type can bitrate 1000000 dbitrate 5000000 fd on`（docs/can.md）"
            ),
            Self::AdapterNoFd { name, kbit } => format!(
                "`{name}` 处的适配器不能以 {kbit} kbit/s 的数据段速率收发 FD 帧：固件支持 `Y` 命令的适配器（CANable 2.0）可以，速率为 \
                 1、2、4、5 或 8 Mbit/s（docs/can.md）"
            ),
            Self::Down { name } => format!(
                "接口 `{name}` 未启用：请执行 `ip link set {name} up`（真实接口须先设置波特率：`ip link set {name} type can \
                 bitrate 1000000`）"
            ),
            Self::Gone { name } => format!("接口 `{name}` 已消失：适配器被拔出，还是接口被删除？"),
            Self::NoPermission { name } => format!(
                "没有使用 `{name}` 的权限；串口设备需要加入其用户组（`usermod -a -G dialout $USER`，然后重新登录），套接字需要其\
                 所有者授权（docs/can.md）"
            ),
            Self::Stuck { name } => format!(
                "`{name}` 已有较长时间未能发出任何报文：无人应答（没有其它节点、断线或波特率不同）、总线已满，或发送队列太短（`ip link \
                 set {name} txqueuelen 1000`）"
            ),
            Self::AdapterStuck { name } => format!(
                "`{name}` 处的适配器已有较长时间未能发出任何报文：总线上无人应答（没有其它节点、断线或波特率不同），或适配器死机；\
                 请拔下后重新插上"
            ),
            Self::NoMachine { name, running } => {
                let now = match &running[..] {
                    [] => String::new(),
                    running => format!("（正在运行的有：{}）", running.join("、")),
                };
                format!("没有正在运行的模拟机床 `{name}`{now}；可用 `leadscrew up --name {name}` 启动")
            }
            Self::FolderOfOthers { folder, owner } => {
                let why = match owner {
                    Some(uid) => format!("属于用户 {uid}：请让其删除"),
                    None => format!("对其他人开放，或者不是文件夹：请删除它（`rm -r {folder}`）"),
                };
                format!("`{folder}` 是存放模拟机床的文件夹，但它{why}，或把 XDG_RUNTIME_DIR 设为自己的文件夹（docs/desk.md）")
            }
            Self::NoDevice { name } => {
                format!("没有 `{name}`；适配器插好了吗？提供它的程序启动了吗？")
            }
            Self::NotSerial { name } => format!(
                "`{name}` 不是串口：请写适配器的设备（`slcan:/dev/ttyACM0`）、套接字（`slcan:unix:{name}`），或直接写内核接口名（\
                 `can0`）"
            ),
            Self::Busy { name } => format!("`{name}` 正被其它程序使用，或拒绝连接"),
            Self::NoSuchBaud { name, baud } => format!(
                "串口不能以 {baud} 波特工作；多数适配器使用 `{name}@115200`"
            ),
            Self::AdapterSilent { name, command } => format!(
                "`{name}` 处的适配器没有应答 `{command}`：它是 Lawicel（SLCAN）适配器吗？串口速率对吗（`slcan:{name}@115200`）？"
            ),
            Self::AdapterRefused { name, command } => format!(
                "`{name}` 处的适配器拒绝 `{command}`；请重新插拔，并确认它支持此命令"
            ),
            Self::Closed { name } => {
                format!("`{name}` 已关闭连接：适配器被拔出，或其程序已结束")
            }
            Self::System { name, doing, error } => {
                format!("系统拒绝对 `{name}` 的操作（{doing}）：{error}")
            }
        }
    }
}

impl Suspicion {
    /// In Chinese; [`Display`](std::fmt::Display) is the English text.
    #[must_use]
    pub fn chinese(&self) -> String {
        match self {
            Self::BusOff => "总线关闭：控制器累计 256 个错误后已离开总线；请检查接线、终端电阻（两端各 120 Ω）和波特率，然后重新启动\
                 接口：`ip link set IFACE down`、`ip link set IFACE up`"
                .into(),
            Self::BitRate => "线路上只有错误而没有一帧正确报文：波特率可能与其它节点不同；请执行 `ip link set IFACE down`、`ip link \
                 set IFACE type can bitrate 1000000`、`ip link set IFACE up`"
                .into(),
            Self::Alone => "发送的报文无人应答：没有其它节点通电、断线，或其它节点都使用另一波特率".into(),
            Self::Passive(counters) => {
                let now = counters.map_or_else(String::new, |(sending, receiving)| {
                    format!("（现在：发送 {sending}，接收 {receiving}）")
                });
                format!("错误被动：控制器已累计 128 个错误{now}；请检查接线、终端电阻和波特率")
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Both texts contain the words that a user types or must recognise.
    #[test]
    fn names_and_commands_are_the_same_in_both_languages() {
        let name = || String::from("can7");
        let errors = [
            CanError::NotABus,
            CanError::NoCan,
            CanError::NoInterface {
                name: name(),
                known: Vec::new(),
            },
            CanError::NoInterface {
                name: name(),
                known: vec!["can1".into()],
            },
            CanError::NotCan { name: name() },
            CanError::Down { name: name() },
            CanError::NoFd { name: name() },
            CanError::AdapterNoFd {
                name: name(),
                kbit: 7000,
            },
            CanError::Gone { name: name() },
            CanError::NoPermission { name: name() },
            CanError::Stuck { name: name() },
            CanError::AdapterStuck { name: name() },
            CanError::NoDevice { name: name() },
            CanError::NoMachine {
                name: name(),
                running: vec!["can1".into()],
            },
            CanError::FolderOfOthers {
                folder: name(),
                owner: Some(7),
            },
            CanError::FolderOfOthers {
                folder: name(),
                owner: None,
            },
            CanError::Busy { name: name() },
            CanError::NoSuchBaud {
                name: name(),
                baud: 7,
            },
            CanError::AdapterSilent {
                name: name(),
                command: "S",
            },
            CanError::AdapterRefused {
                name: name(),
                command: "S",
            },
            CanError::Closed { name: name() },
        ];
        let quoted = |text: &str| -> Vec<String> {
            let parts = text.split('`').skip(1).step_by(2);
            let mut parts: Vec<String> = parts.map(str::to_owned).collect();
            parts.sort();
            parts
        };
        for error in errors {
            let (english, chinese) = (error.to_string(), error.chinese());
            assert_eq!(quoted(&english), quoted(&chinese), "{english}\n{chinese}");
            assert!(!chinese.is_ascii(), "{chinese}");
        }
        for suspicion in [
            Suspicion::BusOff,
            Suspicion::BitRate,
            Suspicion::Alone,
            Suspicion::Passive(Some((130, 7))),
        ] {
            let (english, chinese) = (suspicion.to_string(), suspicion.chinese());
            assert_eq!(quoted(&english), quoted(&chinese), "{english}\n{chinese}");
            assert!(!chinese.is_ascii(), "{chinese}");
        }
    }
}
