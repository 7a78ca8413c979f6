//! What is built upon the figures: the rules and the dashboard of `contrib`, and the page that lists them.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use serde_json::Value;

use crate::{full, parse};

const PREFIX: &str = "leadscrew_";

fn file(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(name);
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Names of the samples, each with its labels.
fn given() -> BTreeMap<String, BTreeSet<String>> {
    let mut names: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for sample in parse(&full().text()).into_keys() {
        let (name, labels) = sample.split_once('{').unwrap_or((&sample, ""));
        let labels = labels.trim_end_matches('}').split(',');
        let labels = labels.filter_map(|label| Some(label.split_once('=')?.0.to_owned()));
        names.entry(name.to_owned()).or_default().extend(labels);
    }
    names
}

fn is_name(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_'
}

/// The figures that a query asks for, each with the labels that it is chosen by.
fn asked(query: &str) -> Vec<(String, Vec<String>)> {
    let mut names = Vec::new();
    for (at, _) in query.match_indices(PREFIX) {
        if query[..at].ends_with(is_name) {
            continue;
        }
        let rest = &query[at..];
        let end = rest.find(|c| !is_name(c)).unwrap_or(rest.len());
        let (name, rest) = rest.split_at(end);
        let chosen = rest.strip_prefix('{').and_then(|rest| rest.split_once('}'));
        let labels = chosen.map_or("", |(labels, _)| labels).split(',');
        let labels = labels.filter_map(|label| Some(label.split(['=', '!']).next()?.to_owned()));
        let labels = labels.filter(|label| !label.is_empty());
        names.push((name.to_owned(), labels.collect()));
    }
    names
}

#[track_caller]
fn check(query: &str) {
    let given = given();
    for (name, labels) in asked(query) {
        let has = given.get(&name);
        let has = has.unwrap_or_else(|| panic!("`{name}` is no figure of the agent: {query}"));
        for label in labels {
            assert!(
                has.contains(&label),
                "`{name}` has no label `{label}`: {query}"
            );
        }
    }
}

#[test]
fn a_query_is_taken_apart() {
    let query =
        r#"sum by (a) (rate(leadscrew_x_total{machine=~"a b",end!="c"}[1h])) + leadscrew_y"#;
    let labels = ["machine", "end"].map(str::to_owned).to_vec();
    assert_eq!(
        asked(query),
        [
            ("leadscrew_x_total".to_owned(), labels),
            ("leadscrew_y".to_owned(), Vec::new())
        ]
    );
}

#[test]
fn every_figure_of_the_rules_is_given() {
    let rules = file("contrib/prometheus/leadscrew.rules.yml");
    check(&rules);
    assert!(
        asked(&rules).len() >= rules.matches("- alert:").count() - 1,
        "a rule without a figure"
    );
}

/// All texts under a key, wherever it stands.
fn under<'a>(value: &'a Value, key: &str, found: &mut Vec<&'a Value>) {
    match value {
        Value::Object(object) => {
            found.extend(object.get(key));
            object.values().for_each(|value| under(value, key, found));
        }
        Value::Array(values) => values.iter().for_each(|value| under(value, key, found)),
        _ => {}
    }
}

#[test]
fn every_figure_of_the_dashboard_is_given_and_every_one_is_shown() {
    let dashboard: Value = serde_json::from_str(&file("contrib/grafana/leadscrew.json")).unwrap();
    let mut queries = Vec::new();
    under(&dashboard, "expr", &mut queries);
    assert!(queries.len() > 20, "{}", queries.len());
    let mut shown = BTreeSet::new();
    for query in queries {
        let query = query.as_str().unwrap();
        check(query);
        let names = asked(query);
        assert!(!names.is_empty(), "{query}");
        shown.extend(names.into_iter().map(|(name, _)| name));
    }
    for name in given().keys() {
        let beside = ["_sum", "_count"].iter().any(|end| name.ends_with(end));
        // The ticks are for who wants to see a start.
        let is_shown = shown.contains(name) || beside || name.ends_with("board_ticks");
        assert!(is_shown, "`{name}` is on no panel");
    }
    let mut sources = Vec::new();
    under(&dashboard, "datasource", &mut sources);
    assert!(
        sources
            .iter()
            .all(|source| source["uid"] == "${datasource}")
    );
    let mut places = Vec::new();
    under(&dashboard, "gridPos", &mut places);
    let cells = places.iter().flat_map(|place| {
        let [x, y, w, h] = ["x", "y", "w", "h"].map(|key| place[key].as_u64().unwrap());
        (x..x + w).flat_map(move |x| (y..y + h).map(move |y| (x, y)))
    });
    let mut taken = BTreeSet::new();
    for cell in cells {
        assert!(cell.0 < 24 && taken.insert(cell), "{cell:?}");
    }
}

#[test]
fn every_figure_stands_in_the_page() {
    let page = file("docs/agent.md");
    for name in given().keys() {
        let name = name.strip_prefix(PREFIX).expect(name);
        let name = ["_bucket", "_sum", "_count"]
            .iter()
            .find_map(|end| name.strip_suffix(end))
            .unwrap_or(name);
        assert!(page.contains(&format!("`{name}")), "{name}");
    }
}
