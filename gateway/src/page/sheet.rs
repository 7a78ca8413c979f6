//! A measured thread as a page: its picture, and the sheet as text.

use leadscrew_core::alarm::Lang;

use super::escaped;
use crate::words::pick;

/// The document. It needs nothing else.
#[must_use]
pub fn sheet(title: &str, svg: &str, sheet: &str, lang: Lang) -> String {
    format!(
        "<!DOCTYPE html>\n<html lang=\"{language}\">\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n<title>{title}</title>\n<style>\n\
         :root{{color-scheme:light dark}}\nbody{{max-width:1280px;margin:1rem auto;font-family:system-ui,sans-serif}}\n\
         svg{{width:100%;height:auto}}\npre{{font:14px/1.45 ui-monospace,monospace;overflow-x:auto}}\n</style>\n\
         <figure>{svg}</figure>\n<pre>\n{sheet}</pre>\n</html>\n",
        language = pick(lang, "en", "zh-CN"),
        title = escaped(title),
        svg = svg.trim_end(),
        sheet = escaped(sheet),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_stays_text() {
        let page = sheet("a & b", "<svg></svg>\n", "1 < 2\n", Lang::Zh);
        assert!(page.contains("<title>a &amp; b</title>") && page.contains("1 &lt; 2\n"));
        assert!(page.contains("lang=\"zh-CN\"") && page.contains("<figure><svg></svg></figure>"));
    }
}
