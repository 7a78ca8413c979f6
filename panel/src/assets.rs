//! The page: its files as they are in `page`, none of them made by a tool. Knows nothing of requests.

/// A file by its path: what it is, and its text.
pub fn find(path: &str) -> Option<(&'static str, &'static str)> {
    const SCRIPT: &str = "text/javascript; charset=utf-8";
    Some(match path {
        "/" => (
            "text/html; charset=utf-8",
            include_str!("../page/index.html"),
        ),
        "/style.css" => ("text/css; charset=utf-8", include_str!("../page/style.css")),
        "/path.js" => (SCRIPT, include_str!("../page/path.js")),
        "/programs.js" => (SCRIPT, include_str!("../page/programs.js")),
        "/text.js" => (SCRIPT, include_str!("../page/text.js")),
        "/view.js" => (SCRIPT, include_str!("../page/view.js")),
        "/panel.js" => (SCRIPT, include_str!("../page/panel.js")),
        "/press.js" => (SCRIPT, include_str!("../page/press.js")),
        "/show.js" => (SCRIPT, include_str!("../page/show.js")),
        "/sheets.js" => (SCRIPT, include_str!("../page/sheets.js")),
        "/table.js" => (SCRIPT, include_str!("../page/table.js")),
        "/threads.js" => (SCRIPT, include_str!("../page/threads.js")),
        "/retract.js" => (SCRIPT, include_str!("../page/retract.js")),
        "/touch.js" => (SCRIPT, include_str!("../page/touch.js")),
        "/transport.js" => (SCRIPT, include_str!("../page/transport.js")),
        "/words.js" => (SCRIPT, include_str!("../page/words.js")),
        _ => return None,
    })
}
