//! A broker as the options name it, for every command that talks to one: who is let in, whose certificate is believed, and
//! what is wrong with that, in two languages.

use std::path::Path;

use leadscrew_agent::mqtt::{Address, Fault, Identity, Login, Refusal, Tls, WireError};
use leadscrew_agent::sparkplug::NameError;

use crate::cli::Access;
use crate::failure::{Failure, Outcome};
use crate::words::{Both, both};

/// User and password.
///
/// # Errors
/// The file cannot be used.
pub fn login(access: &Access) -> Outcome<Option<Login>> {
    let Some(path) = &access.login else {
        return Ok(None);
    };
    let login = Login::read(path).map_err(|error| wrong_login(path, &error))?;
    Ok(Some(login))
}

/// TLS, where the address wants it.
///
/// # Errors
/// The authorities are missing, unusable, or of no use.
pub fn tls(address: &Address, access: &Access) -> Outcome<Option<Tls>> {
    match &access.ca {
        Some(path) if address.tls => {
            let identity = match &access.identity {
                Some(file) => {
                    Some(Identity::read(file).map_err(|error| wrong_identity(file, &error))?)
                }
                None => None,
            };
            let tls = Tls::with(path, identity.as_ref());
            let tls = tls.map_err(|error| match (&access.identity, &error) {
                // What is wrong with the authorities has names of its own.
                (Some(file), WireError::Tls(_)) => wrong_identity(file, &error),
                _ => wrong_authority(path, &error),
            })?;
            Ok(Some(tls))
        }
        None if address.tls => Err(Failure::Usage(both!(
            "a broker by TLS needs the certificate of its authority: name the file with --ca",
            "通过 TLS 连接代理服务器需要其签发机构的证书：请用 --ca 指定文件"
        ))),
        Some(_) => Err(Failure::Usage(both!(
            "--ca is for a broker by TLS: mqtts://HOST",
            "--ca 只用于 TLS 代理服务器：mqtts://HOST"
        ))),
        None => Ok(None),
    }
}

/// A name that no topic can have.
pub fn wrong_name(error: &NameError) -> Failure {
    let NameError(name) = error;
    Failure::Usage(both!(
        "`{name}` can be no part of a topic: leave out / + # and control characters",
        "`{name}` 不能作为主题的一部分：请去掉 / + # 和控制字符"
    ))
}

/// A file of user and password that cannot be used.
fn wrong_login(path: &Path, error: &WireError) -> Failure {
    let path = path.display();
    Failure::Usage(match error {
        WireError::Open => both!(
            "others than its owner may read `{path}`, which holds a password: chmod 600 `{path}`",
            "`{path}` 含有密码，却允许其他用户读取：请执行 chmod 600 `{path}`"
        ),
        WireError::Lines => both!(
            "`{path}` is to have two lines, the user and the password",
            "`{path}` 应有两行：用户名和密码"
        ),
        other => both!(
            "cannot read `{path}`: {other}",
            "无法读取 `{path}`：{other}"
        ),
    })
}

/// A file of authorities that cannot be used.
fn wrong_authority(path: &Path, error: &WireError) -> Failure {
    let path = path.display();
    Failure::Usage(match error {
        WireError::NoCertificate => both!(
            "`{path}` holds no certificate in PEM: name the authority's file with --ca",
            "`{path}` 中没有 PEM 证书：请用 --ca 指定签发机构的文件"
        ),
        WireError::Processor => both!(
            "no TLS on this processor: {error}; use another computer, or mqtt:// in a network of \
             your own",
            "此处理器不支持所需的 TLS 指令：{error}；请使用另一台计算机，或在自有网络中使用 mqtt://"
        ),
        other => both!(
            "cannot use `{path}` of --ca: {other}",
            "无法使用 --ca 的 `{path}`：{other}"
        ),
    })
}

/// A file of certificate and key that cannot be used.
fn wrong_identity(path: &Path, error: &WireError) -> Failure {
    let path = path.display();
    Failure::Usage(match error {
        WireError::Open => both!(
            "others than its owner may read `{path}`, which holds a private key: chmod 600 `{path}`",
            "`{path}` 含有私钥，却允许其他用户读取：请执行 chmod 600 `{path}`"
        ),
        WireError::NoCertificate | WireError::NoKey => both!(
            "`{path}` is to hold the certificate of this client and its private key, both as PEM: {error}",
            "`{path}` 应包含本客户端的 PEM 证书及其私钥：{error}"
        ),
        other => both!(
            "cannot use `{path}` of --identity: {other}",
            "无法使用 --identity 的 `{path}`：{other}"
        ),
    })
}

/// Why there is no way to a broker, with what helps.
pub fn no_way(error: &WireError) -> Both {
    match error {
        WireError::Ended => both!(
            "the connection was ended without a word; where the port is for TLS, it wants mqtts:// and --ca",
            "连接未收到任何数据即被关闭；如果该端口使用 TLS，请用 mqtts:// 和 --ca"
        ),
        WireError::Dropped => both!(
            "the broker has ended the connection: it was ended itself, or another client has connected by the same name; an \
             agent needs a --name of its own",
            "代理服务器断开了连接：它已停止，或另一客户端以相同名称连接；每个代理程序须有自己的 --name"
        ),
        WireError::NoTls => both!(
            "what is there does not answer in TLS; where the port is one without, it wants mqtt://",
            "对方没有以 TLS 应答；如果该端口不使用 TLS，请用 mqtt://"
        ),
        other => Both::same(other.to_string()),
    }
}

/// Why a broker is of no use, with what helps.
pub fn no_use(fault: &Fault) -> Both {
    match fault {
        Fault::Tls => both!(
            "what answers speaks TLS: it wants mqtts:// and --ca",
            "对方使用 TLS：请用 mqtts:// 和 --ca"
        ),
        Fault::Mute => both!(
            "the connection is taken, and nobody answers on it",
            "连接已建立，但没有应答"
        ),
        Fault::Silent => both!("the broker has gone silent", "代理服务器不再应答"),
        Fault::Nonsense(start) => both!(
            "what answers is no MQTT broker: it says {start}",
            "应答的不是 MQTT 代理服务器：{start}"
        ),
        Fault::Refused(Refusal::Version) => both!(
            "the broker does not speak MQTT 3.1.1",
            "代理服务器不支持 MQTT 3.1.1"
        ),
        Fault::Refused(Refusal::Name) => both!(
            "the broker does not take the name of this client",
            "代理服务器不接受此客户端名称"
        ),
        Fault::Refused(Refusal::Closed) => both!(
            "the broker says that it is not in service",
            "代理服务器暂停服务"
        ),
        other @ (Fault::Login | Fault::Orders) => Both::same(other.to_string()),
    }
}

/// The broker is reached over a network without TLS.
pub fn in_the_clear(address: &Address) -> Option<Both> {
    let host = address.host.as_str();
    let is_here = host == "localhost"
        || host
            .parse::<std::net::IpAddr>()
            .is_ok_and(|address| address.is_loopback());
    (!address.tls && !is_here).then(|| {
        both!(
            "warning: everything goes over the network without TLS, user and password with it; use mqtts:// and --ca",
            "警告：所有数据（包括用户名和密码）未经 TLS 在网络上传输；请使用 mqtts:// 和 --ca"
        )
    })
}
