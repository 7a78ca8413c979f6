//! The way to a broker: a socket, with TLS or without.

use std::env;
use std::fmt;
use std::fs;
use std::io::{self, ErrorKind, Read, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::os::unix::fs::PermissionsExt as _;
use std::path::Path;
use std::str::FromStr;
use std::sync::Arc;
use std::time::{Duration, Instant};

use rustls::pki_types::pem::PemObject as _;
use rustls::pki_types::{CertificateDer, PrivateKeyDer, ServerName};
use rustls::{ClientConfig, ClientConnection, InvalidMessage, RootCertStore, StreamOwned};

/// The longest wait for a connection, and for room to write.
const PATIENCE: Duration = Duration::from_secs(10);
/// Ports of brokers, by the registry of ports.
const PLAIN: u16 = 1883;
const WITH_TLS: u16 = 8883;
/// Bits of a file's mode that let others than its owner at it.
const OTHERS: u32 = 0o077;
/// The bit that an access list shows as where it lets one user more read a file.
const LISTED: u32 = 0o040;
/// Where a service manager tells the folder of a service's secrets.
const CREDENTIALS: &str = "CREDENTIALS_DIRECTORY";

/// Where a broker is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Address {
    /// Its host.
    pub host: String,
    /// Its port.
    pub port: u16,
    /// It is reached by TLS.
    pub tls: bool,
}

impl FromStr for Address {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (tls, rest) = match text.split_once("://") {
            Some(("mqtt", rest)) => (false, rest),
            Some(("mqtts", rest)) => (true, rest),
            Some((other, _)) => return Err(format!("`{other}` is neither mqtt nor mqtts")),
            None => (false, text),
        };
        let rest = rest.trim_end_matches('/');
        // An address of IPv6 stands in brackets.
        let end_of_host = rest.rfind(']').map_or(0, |at| at + 1);
        let (host, port) = match rest[end_of_host..].find(':') {
            Some(colon) => {
                let (host, port) = rest.split_at(end_of_host + colon);
                let port = port[1..]
                    .parse()
                    .map_err(|_| format!("`{port}` is no port"))?;
                (host, port)
            }
            None => (rest, if tls { WITH_TLS } else { PLAIN }),
        };
        let host = host.trim_matches(['[', ']']);
        if host.is_empty() || host.contains(['/', '@']) {
            return Err("a broker is mqtt://HOST[:PORT] or mqtts://HOST[:PORT]".to_owned());
        }
        Ok(Self {
            host: host.to_owned(),
            port,
            tls,
        })
    }
}

impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let scheme = if self.tls { "mqtts" } else { "mqtt" };
        if self.host.contains(':') {
            write!(f, "{scheme}://[{}]:{}", self.host, self.port)
        } else {
            write!(f, "{scheme}://{}:{}", self.host, self.port)
        }
    }
}

/// User and password at a broker.
#[derive(Clone)]
pub struct Login {
    /// The user.
    pub user: String,
    /// The password.
    pub password: String,
}

impl fmt::Debug for Login {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Login({})", self.user)
    }
}

/// Why there is no way to a broker.
#[derive(Debug)]
pub enum WireError {
    /// A file cannot be read.
    File(io::Error),
    /// Others may read the file of the password.
    Open,
    /// It does not have the two lines of user and password.
    Lines,
    /// It holds no certificate.
    NoCertificate,
    /// It holds no private key.
    NoKey,
    /// It holds a certificate that no authority can have.
    Authority(rustls::Error),
    /// This processor lacks what TLS is computed with.
    Processor,
    /// TLS cannot be had, or the broker's certificate is not what it has to be.
    Tls(rustls::Error),
    /// The broker cannot be reached, or has ended the connection.
    Socket(io::Error),
    /// The connection has ended before a word came over it.
    Ended,
    /// The other side has ended it after some words.
    Dropped,
    /// It has ended before TLS was agreed upon, or what answers speaks no TLS.
    NoTls,
}

impl fmt::Display for WireError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(error) | Self::Socket(error) => error.fmt(f),
            Self::Open => f.write_str("others than its owner may read it"),
            Self::Lines => f.write_str("it is not two lines, user and password"),
            Self::Processor => {
                f.write_str("this processor lacks AES, AVX2, BMI1 or ADX (aarch64: AES or SHA2)")
            }
            Self::NoCertificate => f.write_str("it holds no certificate"),
            Self::NoKey => f.write_str("it holds no private key"),
            Self::Tls(error) | Self::Authority(error) => error.fmt(f),
            Self::Ended => f.write_str("the connection was ended without a word"),
            Self::Dropped => f.write_str("the other side has ended the connection"),
            Self::NoTls => f.write_str("what is there does not answer in TLS"),
        }
    }
}

impl std::error::Error for WireError {}

impl Login {
    /// The two lines of a file that its owner alone may read.
    ///
    /// # Errors
    /// [`WireError::File`], [`WireError::Open`], [`WireError::Lines`].
    pub fn read(path: &Path) -> Result<Self, WireError> {
        let text = secret(path)?;
        let mut lines = text.lines();
        match (lines.next(), lines.next(), lines.next()) {
            (Some(user), Some(password), None) if !user.is_empty() => Ok(Self {
                user: user.to_owned(),
                password: password.to_owned(),
            }),
            _ => Err(WireError::Lines),
        }
    }
}

/// A file that its owner alone may read.
fn secret(path: &Path) -> Result<String, WireError> {
    let mode = fs::metadata(path).map_err(WireError::File)?.permissions();
    let credentials = env::var_os(CREDENTIALS);
    if is_open(path, mode.mode(), credentials.as_deref().map(Path::new)) {
        return Err(WireError::Open);
    }
    fs::read_to_string(path).map_err(WireError::File)
}

/// True where a file of this mode is open to others than its owner. In the folder of credentials it belongs to root, and an
/// access list lets the service read it, which shows as the group's right [D458].
fn is_open(path: &Path, mode: u32, credentials: Option<&Path>) -> bool {
    let is_given =
        credentials.is_some_and(|folder| folder.is_absolute() && path.parent() == Some(folder));
    let others = if is_given { OTHERS & !LISTED } else { OTHERS };
    mode & others != 0
}

/// Certificates of a file.
fn certificates(pem: &[u8]) -> Result<Vec<CertificateDer<'static>>, WireError> {
    let all: Result<Vec<_>, _> = CertificateDer::pem_slice_iter(pem).collect();
    match all {
        Ok(all) if !all.is_empty() => Ok(all),
        _ => Err(WireError::NoCertificate),
    }
}

/// Whose certificates are believed, and as whom the broker knows this client.
#[derive(Clone, Debug)]
pub struct Tls(Arc<ClientConfig>);

impl Tls {
    /// Those of the authorities in a file, and no others.
    ///
    /// # Errors
    /// [`WireError::Processor`], [`WireError::NoCertificate`], [`WireError::Authority`], [`WireError::Tls`].
    pub fn of(authorities: &Path) -> Result<Self, WireError> {
        Self::with(authorities, None)
    }

    /// The same for a broker that asks for a certificate of this client.
    ///
    /// # Errors
    /// Those of [`Tls::of`]; [`WireError::Tls`] also where certificate and key are not of each other.
    pub fn with(authorities: &Path, identity: Option<&Identity>) -> Result<Self, WireError> {
        if !has_instructions() {
            return Err(WireError::Processor);
        }
        let file = fs::read(authorities).map_err(WireError::File)?;
        let mut roots = RootCertStore::empty();
        for certificate in certificates(&file)? {
            roots.add(certificate).map_err(WireError::Authority)?;
        }
        let provider = Arc::new(rustls_graviola::default_provider());
        let config = ClientConfig::builder_with_provider(provider)
            .with_safe_default_protocol_versions()
            .map_err(WireError::Tls)?
            .with_root_certificates(roots);
        let config = match identity {
            Some(Identity { chain, key }) => config
                .with_client_auth_cert(chain.clone(), key.clone_key())
                .map_err(WireError::Tls)?,
            None => config.with_no_client_auth(),
        };
        Ok(Self(Arc::new(config)))
    }
}

/// As whom a broker by TLS knows this client.
#[derive(Debug)]
pub struct Identity {
    chain: Vec<CertificateDer<'static>>,
    key: PrivateKeyDer<'static>,
}

impl Identity {
    /// From a file in PEM with the certificate of this client, those between it and its authority, and its private key. Its
    /// owner alone may read it.
    ///
    /// # Errors
    /// [`WireError::File`], [`WireError::Open`], [`WireError::NoCertificate`], [`WireError::NoKey`].
    pub fn read(path: &Path) -> Result<Self, WireError> {
        let text = secret(path)?;
        let chain = certificates(text.as_bytes())?;
        let key = PrivateKeyDer::from_pem_slice(text.as_bytes()).map_err(|_| WireError::NoKey)?;
        Ok(Self { chain, key })
    }
}

/// What `graviola` asks of a processor; it does not compute without.
#[cfg(target_arch = "x86_64")]
fn has_instructions() -> bool {
    is_x86_feature_detected!("aes")
        && is_x86_feature_detected!("pclmulqdq")
        && is_x86_feature_detected!("avx2")
        && is_x86_feature_detected!("bmi1")
        && is_x86_feature_detected!("adx")
}

/// What `graviola` asks of a processor; it does not compute without.
#[cfg(target_arch = "aarch64")]
fn has_instructions() -> bool {
    use std::arch::is_aarch64_feature_detected;
    is_aarch64_feature_detected!("aes")
        && is_aarch64_feature_detected!("pmull")
        && is_aarch64_feature_detected!("sha2")
}

trait Stream: Read + Write {
    /// TLS is not agreed upon yet.
    fn is_greeting(&self) -> bool;
}

impl Stream for TcpStream {
    fn is_greeting(&self) -> bool {
        false
    }
}

impl Stream for StreamOwned<ClientConnection, TcpStream> {
    fn is_greeting(&self) -> bool {
        self.conn.is_handshaking()
    }
}

/// A connection.
pub struct Wire {
    stream: Box<dyn Stream>,
    /// Something has come over it, or it is by TLS.
    heard: bool,
}

impl Wire {
    /// Connects; `tls` where the address wants it. Each reading waits `wait` at most.
    ///
    /// # Errors
    /// [`WireError::Socket`], [`WireError::Tls`].
    pub fn open(address: &Address, tls: Option<&Tls>, wait: Duration) -> Result<Self, WireError> {
        let socket = connect(address).map_err(WireError::Socket)?;
        let prepare = || {
            socket.set_nodelay(true)?;
            socket.set_write_timeout(Some(PATIENCE))?;
            socket.set_read_timeout(Some(wait))
        };
        prepare().map_err(WireError::Socket)?;
        let stream: Box<dyn Stream> = match tls {
            None => Box::new(socket),
            Some(Tls(config)) => {
                let name = ServerName::try_from(address.host.clone())
                    .map_err(|_| WireError::Socket(ErrorKind::InvalidInput.into()))?;
                let connection = ClientConnection::new(Arc::clone(config), name);
                let connection = connection.map_err(WireError::Tls)?;
                Box::new(StreamOwned::new(connection, socket))
            }
        };
        Ok(Self {
            stream,
            heard: tls.is_some(),
        })
    }

    /// Reads what is there; nothing where nothing comes in time.
    ///
    /// # Errors
    /// The connection has ended.
    pub fn read<'a>(&mut self, room: &'a mut [u8]) -> Result<&'a [u8], WireError> {
        match self.stream.read(room) {
            Ok(0) => Err(self.fault(ErrorKind::UnexpectedEof.into())),
            Ok(count) => {
                self.heard = true;
                Ok(&room[..count])
            }
            Err(error) if is_early(&error) => Ok(&[]),
            Err(error) => Err(self.fault(error)),
        }
    }

    /// Writes all of it.
    ///
    /// # Errors
    /// The connection has ended.
    pub fn write(&mut self, bytes: &[u8]) -> Result<(), WireError> {
        let end = Instant::now() + PATIENCE;
        let mut rest = bytes;
        while !rest.is_empty() {
            match self.stream.write(rest) {
                Ok(0) => return Err(WireError::Socket(ErrorKind::WriteZero.into())),
                Ok(count) => rest = &rest[count..],
                // The first bytes wait for the handshake of TLS, and so for what the broker says in it.
                Err(error) if is_early(&error) && Instant::now() < end => {}
                Err(error) if is_early(&error) => {
                    return Err(WireError::Socket(ErrorKind::TimedOut.into()));
                }
                Err(error) => return Err(self.fault(error)),
            }
        }
        let flushed = self.stream.flush();
        flushed.map_err(|error| self.fault(error))
    }

    /// What an error means. One of TLS comes as one of the socket.
    fn fault(&self, error: io::Error) -> WireError {
        let is_end = matches!(
            error.kind(),
            ErrorKind::UnexpectedEof | ErrorKind::ConnectionReset | ErrorKind::BrokenPipe
        );
        match error.downcast::<rustls::Error>() {
            Ok(rustls::Error::InvalidMessage(InvalidMessage::InvalidContentType))
                if self.stream.is_greeting() =>
            {
                WireError::NoTls
            }
            Ok(error) => WireError::Tls(error),
            Err(_) if is_end && self.stream.is_greeting() => WireError::NoTls,
            Err(_) if is_end && !self.heard => WireError::Ended,
            Err(_) if is_end => WireError::Dropped,
            Err(error) => WireError::Socket(error),
        }
    }
}

fn is_early(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted
    )
}

fn connect(address: &Address) -> io::Result<TcpStream> {
    let mut last = io::Error::from(ErrorKind::NotFound);
    for place in (address.host.as_str(), address.port).to_socket_addrs()? {
        match TcpStream::connect_timeout(&place, PATIENCE) {
            Ok(socket) => return Ok(socket),
            Err(error) => last = error,
        }
    }
    Err(last)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_credential_may_have_an_access_list_and_nothing_else_may() {
        let folder = Path::new("/run/credentials/agent.service");
        let file = folder.join("login");
        for (mode, is_open_there) in [
            (0o400, false),
            (0o440, false),
            (0o460, true),
            (0o450, true),
            (0o444, true),
            (0o441, true),
        ] {
            assert_eq!(
                is_open(&file, mode, Some(folder)),
                is_open_there,
                "{mode:o}"
            );
        }
        for (path, credentials) in [
            (file.as_path(), None),
            (&file, Some(Path::new("/run/credentials"))),
            (&file, Some(Path::new(""))),
            (&folder.join("below/login"), Some(folder)),
            (Path::new("login"), Some(Path::new(""))),
            (Path::new("/etc/leadscrew/login"), Some(folder)),
        ] {
            assert!(
                is_open(path, 0o440, credentials),
                "{path:?} {credentials:?}"
            );
            assert!(
                !is_open(path, 0o600, credentials),
                "{path:?} {credentials:?}"
            );
        }
    }
}
