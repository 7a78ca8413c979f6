//! Why a request is not answered: its name, its HTTP status, and what helps. Knows nothing of how it is found.

/// One reason.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// The request is no HTTP that this server reads.
    Malformed,
    /// It was not complete in time.
    Slow,
    /// Its head, or what follows it, is too long.
    TooLong,
    /// It names a host that this server is not.
    Host,
    /// A page from elsewhere has sent it.
    Origin,
    /// It is not sent by this page: its header or its type is missing.
    NotThePage,
    /// Nobody has logged in.
    Login,
    /// The token is not that of this server.
    Token,
    /// There is nothing of this name.
    NotFound,
    /// It is there, but not to be asked in this way.
    Method,
    /// Too many connections, or too many that watch.
    Busy,
    /// The link lets its owner look only.
    Looks,
    /// Another page operates, or none.
    NotOperating,
    /// A newer order of this page has come before.
    Older,
    /// The panel was started without a folder of programs.
    NoStore,
    /// The name is none that a program may have.
    Name,
    /// There is no such program.
    NoProgram,
    /// Somebody else has changed it meanwhile.
    Changed,
    /// It does not say what it is meant to replace.
    Unconditional,
    /// The machine runs this program.
    Runs,
    /// The folder cannot be read or written.
    Disk,
}

impl Refusal {
    /// All of them.
    pub const ALL: [Self; 21] = [
        Self::Malformed,
        Self::Slow,
        Self::TooLong,
        Self::Host,
        Self::Origin,
        Self::NotThePage,
        Self::Login,
        Self::Token,
        Self::NotFound,
        Self::Method,
        Self::Busy,
        Self::Looks,
        Self::NotOperating,
        Self::Older,
        Self::NoStore,
        Self::Name,
        Self::NoProgram,
        Self::Changed,
        Self::Unconditional,
        Self::Runs,
        Self::Disk,
    ];

    /// The name that programs go by.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Malformed => "malformed",
            Self::Slow => "slow",
            Self::TooLong => "too_long",
            Self::Host => "host",
            Self::Origin => "origin",
            Self::NotThePage => "not_the_page",
            Self::Login => "login",
            Self::Token => "token",
            Self::NotFound => "not_found",
            Self::Method => "method",
            Self::Busy => "busy",
            Self::Looks => "looks",
            Self::NotOperating => "not_operating",
            Self::Older => "older",
            Self::NoStore => "no_store",
            Self::Name => "name",
            Self::NoProgram => "no_program",
            Self::Changed => "changed",
            Self::Unconditional => "unconditional",
            Self::Runs => "runs",
            Self::Disk => "disk",
        }
    }

    /// The status line.
    #[must_use]
    pub const fn status(self) -> &'static str {
        match self {
            Self::Malformed | Self::Name => "400 Bad Request",
            Self::Slow => "408 Request Timeout",
            Self::TooLong => "413 Content Too Large",
            Self::Host => "421 Misdirected Request",
            Self::Origin | Self::Looks => "403 Forbidden",
            Self::NotThePage => "415 Unsupported Media Type",
            Self::Login | Self::Token => "401 Unauthorized",
            Self::NotFound | Self::NoStore | Self::NoProgram => "404 Not Found",
            Self::Method => "405 Method Not Allowed",
            Self::NotOperating | Self::Older | Self::Runs => "409 Conflict",
            Self::Changed => "412 Precondition Failed",
            Self::Unconditional => "428 Precondition Required",
            Self::Disk => "500 Internal Server Error",
            Self::Busy => "503 Service Unavailable",
        }
    }

    /// Cause and remedy: English, Chinese.
    #[must_use]
    pub const fn words(self) -> [&'static str; 2] {
        match self {
            Self::Malformed => [
                "this is no request that the panel reads; use the page",
                "请求格式无效；请使用本页面",
            ],
            Self::Slow => [
                "the request was not complete within 5 s; look at the network, then load the page again",
                "请求未在 5 秒内完成；请检查网络后重新加载页面",
            ],
            Self::TooLong => [
                "the request is longer than the panel reads; use the page",
                "请求过长；请使用本页面",
            ],
            Self::Host => [
                "the panel is not known by this name; open the link that it has printed, or start it with --host NAME",
                "面板没有这个主机名；请打开启动时显示的链接，或用 --host 名称 启动",
            ],
            Self::Origin => [
                "another page has sent this; open the link that the panel has printed",
                "请求来自其他网页；请打开面板启动时显示的链接",
            ],
            Self::NotThePage => [
                "a page of the panel sends JSON and names itself; load the page again",
                "请求不是由面板页面发出的；请重新加载页面",
            ],
            Self::Login => [
                "nobody has logged in here; open the link that the panel has printed",
                "尚未登录；请打开面板启动时显示的链接",
            ],
            Self::Token => [
                "this link is of a panel that was started before; open the link of this one",
                "该链接属于以前启动的面板；请打开本次启动的链接",
            ],
            Self::NotFound => [
                "there is nothing of this name; open the link that the panel has printed",
                "没有该页面；请打开面板启动时显示的链接",
            ],
            Self::Method => [
                "this is not asked in this way; load the page again",
                "请求方法不对；请重新加载页面",
            ],
            Self::Busy => [
                "too many pages are open; close some of them",
                "打开的页面太多；请关闭一些",
            ],
            Self::Looks => [
                "this link lets you look only; to operate, open the other link that the panel has printed",
                "该链接只能查看；要操作，请打开面板启动时显示的操作链接",
            ],
            Self::NotOperating => [
                "this page does not operate the machine; take it over with the button for that, then order again",
                "本页面当前没有操作权；请先按接管按钮，再下达指令",
            ],
            Self::Older => [
                "a newer order of this page has come before this one, so it does nothing; look, then order again",
                "本页面更新的指令已先到达，此指令不执行；请查看后重新下达",
            ],
            Self::NoStore => [
                "the panel has no folder of programs; start it with --programs DIR",
                "面板没有程序文件夹；请用 --programs 文件夹 启动",
            ],
            Self::Name => [
                "no program can have this name; use 1 to 64 letters, digits, `.`, `_`, `-`, and no dot in front",
                "程序名无效；请用 1 至 64 个字母、数字、`.`、`_`、`-`，且不以点开头",
            ],
            Self::NoProgram => [
                "the folder of programs has no such program; load the list again",
                "程序文件夹中没有该程序；请重新加载列表",
            ],
            Self::Changed => [
                "it is not what this page has seen: somebody has changed it meanwhile, or the name is taken; open it again, then change it",
                "内容与本页面所见不同：已被他人修改，或名称已被占用；请重新打开后再修改",
            ],
            Self::Unconditional => [
                "the request does not say what it replaces (If-Match, or If-None-Match: *); use the page",
                "请求未说明要替换的内容（If-Match 或 If-None-Match: *）；请使用本页面",
            ],
            Self::Runs => [
                "the machine runs this program, or another one from here; let it end first",
                "机床正在运行该程序或由此启动的其他程序；请等其结束",
            ],
            Self::Disk => [
                "the folder of programs cannot be read or written; look at its rights and at the disk of the panel's computer",
                "无法读写程序文件夹；请检查其权限和面板计算机的磁盘",
            ],
        }
    }

    /// All of it, as an answer.
    #[must_use]
    pub fn json(self) -> String {
        let [en, zh] = self.words();
        serde_json::json!({"refused": self.name(), "en": en, "zh": zh}).to_string()
    }
}
