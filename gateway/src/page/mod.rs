//! The picture of a program as a page: one file that a browser opens without a network. The path and the views of the cut
//! can be zoomed and moved and say the line under the pointer; the path is played. Above stands what is wrong with moves,
//! below what the machine did over time.
//!
//! Turns strokes and samples into text; knows nothing of programs or machines. What the page does with them is
//! `page.js`.

mod sheet;
mod way;

use std::fmt::Write as _;

use leadscrew_core::alarm::Lang;

pub use self::sheet::sheet;
pub use self::way::Way;

use crate::json::Json;
use crate::number::measured;
use crate::output;
use crate::plot::{Kind, Mark, Stock, Stroke};
use crate::words::pick;

/// Everything that goes into a page.
#[derive(Debug)]
pub struct Page<'a> {
    /// First line.
    pub title: &'a str,
    /// Second line: the figures.
    pub subtitle: &'a str,
    /// Language of the labels.
    pub lang: Lang,
    /// The tool path in the order of execution.
    pub path: &'a [Stroke],
    /// What there is before the first cut, where it is known.
    pub stock: Option<&'a Stock>,
    /// Where warnings of moves are.
    pub marks: &'a [Mark],
    /// The warnings in words, each with its line of the program's file, or 0.
    pub told: Vec<(u32, String)>,
    /// The lines of the program's file.
    pub program: Vec<String>,
    /// Where the tool was over time; `None` where nothing ran.
    pub way: Option<Way>,
    /// What is cut, near by, as SVG.
    pub cuts: Option<String>,
    /// What the machine did over time, as SVG.
    pub over_time: Option<String>,
}

impl Page<'_> {
    /// The document.
    pub fn html(&self) -> String {
        let lang = self.lang;
        let mut page = String::from("<!DOCTYPE html>\n");
        let language = pick(lang, "en", "zh-CN");
        let (title, subtitle) = (escaped(self.title), escaped(self.subtitle));
        let _ = write!(
            page,
            "<html lang=\"{language}\">\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n<title>{title}</title>\n\
             <style>\n{}</style>\n<header><h1>{title}</h1><p>{subtitle}</p>{}</header>\n",
            include_str!("page.css"),
            self.warnings(),
        );
        page.push_str(&self.view());
        if let Some(svg) = &self.cuts {
            let hint = pick(
                lang,
                "a click on a view brings it near; then the wheel zooms, a drag moves, a double click shows all",
                "单击视图可放大；放大后滚轮缩放、拖动平移，双击恢复全部",
            );
            let _ = writeln!(
                page,
                "<figure class=\"cuts\"><output>{hint}</output>{}</figure>",
                svg.trim_end()
            );
        }
        if let Some(svg) = &self.over_time {
            let _ = writeln!(page, "<figure>{}</figure>", svg.trim_end());
        }
        // No text of the program can end the element.
        let data = self.data().replace('<', "\\u003c");
        let _ = write!(
            page,
            "<script type=\"application/json\" id=\"data\">{data}</script>\n<script>\n{}</script>\n</html>\n",
            include_str!("page.js")
        );
        page
    }

    /// What is wrong with moves, in words.
    fn warnings(&self) -> String {
        if self.told.is_empty() {
            return String::new();
        }
        let item = |(row, words): &(u32, String)| {
            format!("<li data-line=\"{row}\">{}</li>\n", escaped(words))
        };
        let items: String = self.told.iter().map(item).collect();
        let label = pick(self.lang, "warnings", "警告");
        format!("\n<ul id=\"warnings\" aria-label=\"{label}\">\n{items}</ul>")
    }

    /// The path with its controls, and the program.
    fn view(&self) -> String {
        let word = |en, zh| pick(self.lang, en, zh);
        let keys: String = [Kind::Rapid, Kind::Feed, Kind::Thread, Kind::Tap]
            .into_iter()
            .filter(|kind| self.path.iter().any(|stroke| stroke.kind == *kind))
            .map(|kind| {
                let (name, words) = (kind.class(), self.kind(kind));
                format!("<span class=\"key\" style=\"color:var(--{name})\">{words}</span>\n")
            })
            .chain(self.warned())
            .collect();
        format!(
            "<main>\n<section>\n<canvas id=\"path\" aria-label=\"{path}\"></canvas>\n<div class=\"bar\">\n\
             <button id=\"part\">{part}</button>\n<button id=\"whole\">{whole}</button>\n\
             <label>{stretch} <select id=\"stretch\"><option value=\"1\">×1</option><option value=\"4\">×4</option>\
             <option value=\"16\">×16</option></select></label>\n{keys}<output id=\"told\"></output>\n</div>\n\
             <div class=\"bar run\">\n<button id=\"play\" aria-label=\"{play}\">▶</button>\n\
             <input id=\"time\" type=\"range\" min=\"0\" value=\"0\" aria-label=\"{time}\">\n\
             <output id=\"clock\">0.00 s</output>\n<label>{speed} <select id=\"speed\"><option>1</option>\
             <option>4</option><option selected>16</option><option>64</option></select>×</label>\n</div>\n\
             </section>\n<ol id=\"program\" aria-label=\"{program}\"></ol>\n</main>\n",
            path = word(
                "tool path, Z to the right, X upwards as a diameter",
                "刀具轨迹，Z 向右，X（直径）向上"
            ),
            part = word("part", "工件"),
            whole = word("all", "全部"),
            stretch = word("X drawn", "X 方向"),
            play = word("play", "播放"),
            time = word("time", "时间"),
            speed = word("speed", "速度"),
            program = word("program", "程序"),
        )
    }

    /// The key of rapids through the material, where there are any.
    fn warned(&self) -> Option<String> {
        let mark = self.marks.iter().find(|mark| mark.is_rapid)?;
        let words = escaped(&mark.words);
        Some(format!(
            "<span class=\"key\" style=\"color:var(--warn)\">{words}</span>\n"
        ))
    }

    fn kind(&self, kind: Kind) -> &'static str {
        match kind {
            Kind::Rapid => pick(self.lang, "rapid", "快速移动"),
            Kind::Feed => pick(self.lang, "feed", "切削进给"),
            Kind::Thread => pick(self.lang, "thread", "螺纹"),
            Kind::Tap => pick(self.lang, "tap", "攻丝"),
        }
    }

    /// What the script reads.
    fn data(&self) -> String {
        let line = output::line(|json| {
            json.object_at("words", |json| {
                json.text("line", pick(self.lang, ", line {}: ", "，第 {} 行："));
                for kind in [Kind::Rapid, Kind::Feed, Kind::Thread, Kind::Tap] {
                    json.text(kind.class(), self.kind(kind));
                }
            });
            json.array_at("program", |json| {
                for line in &self.program {
                    json.text_item(line);
                }
            });
            json.array_at("strokes", |json| {
                for stroke in self.path {
                    json.object(|json| stroke_fields(json, stroke));
                }
            });
            if let Some(stock) = self.stock {
                json.array_at("stock", |json| {
                    for side in [
                        stock.face - stock.length,
                        stock.bore,
                        stock.face,
                        stock.outside,
                    ] {
                        json.item(&measured(side));
                    }
                });
            }
            json.array_at("marks", |json| {
                for mark in self.marks {
                    json.object(|json| mark_fields(json, mark));
                }
            });
            if let Some(way) = &self.way {
                json.object_at("run", |json| way.fields(json));
            }
        });
        String::from_utf8_lossy(&line).trim_end().to_owned()
    }
}

fn stroke_fields(json: &mut Json, stroke: &Stroke) {
    json.text("k", stroke.kind.class());
    json.integer("l", stroke.line.into());
    places(json, "p", &stroke.points);
}

fn mark_fields(json: &mut Json, mark: &Mark) {
    json.text("line", &mark.line);
    json.integer("l", mark.row.into());
    json.text("words", &mark.words);
    if mark.is_rapid {
        places(json, "p", &mark.way);
    }
    places(json, "at", &[mark.at]);
}

fn places(json: &mut Json, key: &str, points: &[(f64, f64)]) {
    json.array_at(key, |json| {
        for (z, x) in points {
            json.item(&measured(*z));
            json.item(&measured(*x));
        }
    });
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::Value;

    fn page() -> String {
        let mut way = Way::new(0.001);
        for n in 0..50_000_u32 {
            way.push(n, 500_000, i64::from(n) * -1_000);
        }
        Page {
            title: "a<b>.nc",
            subtitle: "1 & 2",
            lang: Lang::En,
            path: &[Stroke {
                kind: Kind::Thread,
                line: 2,
                points: vec![(0.0, 20.0), (-30.000_05, 20.0)],
            }],
            stock: None,
            marks: &[],
            told: Vec::new(),
            program: vec!["O1 (</script><script>alert(1))".into(), "G32 Z-30".into()],
            way: Some(way),
            cuts: None,
            over_time: Some("<svg></svg>".into()),
        }
        .html()
    }

    #[test]
    fn a_page_needs_nothing_from_elsewhere_and_no_program_ends_its_script() {
        let page = page();
        assert!(!page.contains("http") && !page.contains("src=") && !page.contains("import "));
        assert_eq!(page.matches("</script>").count(), 2);
        assert!(page.contains("<h1>a&lt;b&gt;.nc</h1><p>1 &amp; 2</p>"));
    }

    #[test]
    fn its_data_are_the_strokes_and_the_way_in_work_coordinates() {
        let page = page();
        let (_, data) = page.split_once("id=\"data\">").unwrap();
        let (data, _) = data.split_once("</script>").unwrap();
        let data: Value = serde_json::from_str(data).unwrap();
        assert_eq!(data["strokes"][0]["p"].to_string(), "[0,20,-30.0001,20]");
        assert_eq!(data["strokes"][0]["l"], 2);
        assert_eq!(data["program"][0], "O1 (</script><script>alert(1))");
        let run = &data["run"];
        let count = |key: &str| run[key].as_array().unwrap().len();
        assert_eq!([count("x"), count("z"), count("l")], [12_500; 3]);
        assert_eq!(run["every"], 0.004);
        assert_eq!(
            [&run["x"][7], &run["z"][7]],
            [&Value::from(0.5), &Value::from(-0.028)]
        );
    }
}
