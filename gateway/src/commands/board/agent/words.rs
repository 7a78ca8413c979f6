//! What an agent says to people: what it cannot do and why, and how it is going, in two languages.

use std::path::Path;

use leadscrew_agent::StoreError;
use leadscrew_agent::archive::ArchiveError;
use leadscrew_agent::mqtt::{Fault, WireError};
use leadscrew_agent::sender::{News, Trouble};

use crate::commands::broker;
use crate::failure::Failure;
use crate::words::{Both, both};

/// A store that cannot be opened.
pub fn store(path: &Path, error: &StoreError) -> Failure {
    let path = path.display();
    Failure::Usage(match error {
        StoreError::InUse => both!(
            "another agent has `{path}` open: one machine has one agent; name another machine with --machine, another agent \
             with --name, or another file with --store",
            "另一个代理已打开 `{path}`：一台机床只用一个代理；请用 --machine 指定另一台机床，用 --name 指定另一个代理名，或用 \
             --store 指定另一个文件"
        ),
        StoreError::Nameless => both!(
            "an earlier version kept `{path}` for one machine, and does not say which: run the agent with it once for that \
             machine alone (--machine NAME --store `{path}`), or name another file with --store",
            "`{path}` 由早期版本为一台机床保存，其中没有机床名称：请先单独为该机床运行一次（--machine NAME --store \
             `{path}`），或用 --store 指定另一个文件"
        ),
        StoreError::Foreign => both!(
            "`{path}` is no store of an agent: name another file with --store",
            "`{path}` 不是代理程序的存储文件：请用 --store 指定另一个文件"
        ),
        StoreError::File(error) => both!(
            "`{path}` cannot be opened: {error}; see that its folder is there, may be written and has room, or name another file \
             with --store",
            "无法打开 `{path}`：{error}；请检查文件夹是否存在、可写且有空间，或用 --store 指定另一个文件"
        ),
        StoreError::Content(error) => both!(
            "`{path}` is of another version of this program: {error}; let that version send it, or name another file with \
             --store",
            "`{path}` 属于本程序的另一版本：{error}；请用该版本发送其中的数据，或用 --store 指定另一个文件"
        ),
    })
}

/// A store that takes nothing any more, while the agent goes on.
pub fn not_kept(path: &Path, error: &StoreError) -> Both {
    let path = path.display();
    both!(
        "nothing can be kept in `{path}`: {error}; what the board tells is read again once there is room and leave",
        "无法写入 `{path}`：{error}；恢复空间和权限后会重新读取控制板的数据"
    )
}

/// The disk of the store is full, or is so no more.
pub fn tight(path: &Path, is_tight: bool) -> Both {
    let path = path.display();
    if is_tight {
        both!(
            "the disk of `{path}` is full: the oldest states go, certificates stay as long as the store has room of its own; \
             make room",
            "`{path}` 所在的磁盘已满：删除最早的状态，只要还有预留空间就保留精度证书；请腾出空间"
        )
    } else {
        both!(
            "the disk of `{path}` has room again: nothing goes any more",
            "`{path}` 所在的磁盘又有空间：不再删除数据"
        )
    }
}

/// The store takes records again.
pub fn kept_again() -> Both {
    both!("what the board tells is kept again", "控制板的数据恢复保存")
}

/// A folder of the archive that cannot be written at the beginning.
pub fn no_archive(folder: &Path, error: &std::io::Error) -> Failure {
    let folder = folder.display();
    Failure::Usage(both!(
        "nothing can be written to the archive `{folder}`: {error}; name a folder with --archive that this user may write",
        "无法写入归档 `{folder}`：{error}；请用 --archive 指定当前用户可写的文件夹"
    ))
}

/// A file of the archive that cannot be written.
pub fn archive(folder: &Path, error: &ArchiveError) -> Both {
    let folder = folder.display();
    both!(
        "the archive `{folder}` is not written: {error}; see that it is there, may be written and has room; all is kept \
         meanwhile",
        "无法写入归档 `{folder}`：{error}；请检查文件夹是否存在、可写且有空间；数据仍在保存"
    )
}

/// The archive is written again.
pub fn archived_again() -> Both {
    both!("the archive is written again", "归档恢复写入")
}

/// How the sending is going.
pub fn news(news: &News) -> Both {
    match news {
        News::Connected => both!("the broker takes what is kept", "代理服务器正在接收数据"),
        News::Waiting => both!(
            "the primary host is not there: all is kept until it says that it is",
            "主站（primary host）不在线：在其上线之前数据一直保存"
        ),
        News::Huge(topic) => both!(
            "a message on {topic:?} is too large to be an order, and is dropped: somebody else publishes under the agent's name; \
             the broker's access list is in docs/agent.md",
            "{topic:?} 上的消息过大，不可能是指令，已丢弃：有其他客户端以本代理的名称发布；代理服务器的访问列表见 docs/agent.md"
        ),
        News::Trouble(Trouble::Host) => both!(
            "the primary host has gone: all is kept until it is back",
            "主站（primary host）已离线：在其恢复之前数据一直保存"
        ),
        News::Trouble(Trouble::Broker(Fault::Login)) => both!(
            "the broker refuses user and password: look at the file of --login, and at the broker's list of users; all is \
             kept meanwhile",
            "代理服务器拒绝用户名和密码：请检查 --login 的文件和代理服务器的用户表；数据仍在保存"
        ),
        News::Trouble(Trouble::Broker(Fault::Orders)) => both!(
            "the broker does not let the agent hear requests for births (NCMD) or the state of the primary host (STATE): its access list is in docs/agent.md; all is \
             kept meanwhile",
            "代理服务器不允许接收出生证请求（NCMD）或主站状态（STATE）：访问列表见 docs/agent.md；数据仍在保存"
        ),
        News::Trouble(Trouble::Broker(fault)) => {
            let why = broker::no_use(fault);
            both!(
                "no broker takes what is kept: {en}; all is kept meanwhile",
                "没有代理服务器接收数据：{zh}；数据仍在保存",
                en = why.en,
                zh = why.zh
            )
        }
        News::Trouble(Trouble::Wire(WireError::Tls(error))) => both!(
            "the broker's certificate is not believed, or its TLS is another: {error}; look at --ca and at the name of the \
             host; all is kept meanwhile",
            "代理服务器的证书不可信，或 TLS 不符：{error}；请检查 --ca 和主机名；数据仍在保存"
        ),
        News::Trouble(Trouble::Wire(error)) => {
            let why = broker::no_way(error);
            both!(
                "the broker is not reached: {en}; it is tried again, and all is kept meanwhile",
                "无法连接代理服务器：{zh}；将重试，数据仍在保存",
                en = why.en,
                zh = why.zh
            )
        }
        News::Trouble(Trouble::Store(error)) => both!(
            "what is kept cannot be sent: {error}; it is tried again",
            "保存的数据无法发送：{error}；将重试"
        ),
    }
}
