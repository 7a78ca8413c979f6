//! Bills of materials: what is linked into a program, with versions and licences, as CycloneDX.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use anyhow::{Context, Result};
use serde_json::{Value, json};

use super::linux;
use crate::{image, run, target};

/// Writes a bill for each program of the host, and one for the image.
pub fn make(to: &Path) -> Result<()> {
    fs::create_dir_all(to).with_context(|| format!("cannot make {}", to.display()))?;
    let host = linux::TARGETS.iter().map(|target| target.triple);
    let host: Vec<&str> = host.collect();
    let of_host = metadata(&run::root(), &host)?;
    for (program, package) in linux::PROGRAMS {
        write(
            &bill(&of_host, package)?,
            &to.join(format!("{program}.cdx.json")),
        )?;
    }
    let metadata = metadata(&run::firmware(), &[target::TARGET])?;
    let bill = bill(&metadata, image::PROGRAM)?;
    write(&bill, &to.join(format!("{}.cdx.json", image::PROGRAM)))
}

fn write(bill: &Value, path: &Path) -> Result<()> {
    let text = serde_json::to_string_pretty(bill)?;
    fs::write(path, text).with_context(|| format!("cannot write {}", path.display()))
}

fn metadata(workspace: &Path, targets: &[&str]) -> Result<Value> {
    let platforms: Vec<&str> = targets
        .iter()
        .flat_map(|target| ["--filter-platform", target])
        .collect();
    run::metadata(workspace, &platforms)
}

/// The bill of a package. What only builds or tests it is not in it.
fn bill(metadata: &Value, program: &str) -> Result<Value> {
    let packages = by_id(&metadata["packages"]);
    let nodes = by_id(&metadata["resolve"]["nodes"]);
    let root = packages
        .iter()
        .find(|(_, package)| package["name"] == program)
        .map(|(id, _)| *id)
        .with_context(|| format!("there is no package {program}"))?;

    let mut needs = BTreeMap::new();
    let mut open = vec![root];
    while let Some(id) = open.pop() {
        if needs.contains_key(id) {
            continue;
        }
        let below = linked(nodes.get(id).copied().unwrap_or(&Value::Null));
        open.extend(below.iter().copied());
        needs.insert(id, below);
    }
    let reference = |id: &str| packages.get(id).map(|package| purl(package));
    let components: Vec<Value> = needs
        .keys()
        .filter(|id| **id != root)
        .filter_map(|id| Some(component(packages.get(id)?, "library")))
        .collect();
    let dependencies: Vec<Value> = needs
        .iter()
        .map(|(id, below)| {
            let on: Vec<_> = below.iter().filter_map(|id| reference(id)).collect();
            json!({"ref": reference(id), "dependsOn": on})
        })
        .collect();
    Ok(json!({
        "bomFormat": "CycloneDX",
        "specVersion": "1.5",
        "version": 1,
        "metadata": {"component": component(packages[root], "application")},
        "components": components,
        "dependencies": dependencies,
    }))
}

fn by_id(list: &Value) -> BTreeMap<&str, &Value> {
    let all = list.as_array().into_iter().flatten();
    all.filter_map(|one| Some((one["id"].as_str()?, one)))
        .collect()
}

/// What is linked into the package of a node.
fn linked(node: &Value) -> BTreeSet<&str> {
    let needed = node["deps"].as_array().into_iter().flatten();
    let is_linked = |needed: &&Value| {
        let kinds = needed["dep_kinds"].as_array().into_iter().flatten();
        kinds.into_iter().any(|kind| kind["kind"].is_null())
    };
    needed
        .filter(is_linked)
        .filter_map(|needed| needed["pkg"].as_str())
        .collect()
}

fn component(package: &Value, kind: &str) -> Value {
    json!({
        "type": kind,
        "bom-ref": purl(package),
        "name": package["name"],
        "version": package["version"],
        "purl": purl(package),
        "licenses": [{"expression": package["license"].as_str().unwrap_or_default().replace('/', " OR ")}],
    })
}

fn purl(package: &Value) -> String {
    let text = |key: &str| package[key].as_str().unwrap_or_default();
    format!("pkg:cargo/{}@{}", text("name"), text("version"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_linked_is_in_the_bill_and_what_only_builds_it_is_not() {
        let package = |id: &str| json!({"id": id, "name": id, "version": "1.0.0", "license": "MIT/Apache-2.0"});
        let need = |id: &str, kind: Value| json!({"pkg": id, "dep_kinds": [{"kind": kind}]});
        let metadata = json!({
            "packages": [package("program"), package("linked"), package("below"), package("builds"), package("other")],
            "resolve": {"nodes": [
                {"id": "program", "deps": [need("linked", Value::Null), need("builds", json!("build"))]},
                {"id": "linked", "deps": [need("below", Value::Null)]},
                {"id": "below", "deps": [need("linked", Value::Null)]},
                {"id": "builds", "deps": [need("other", Value::Null)]},
            ]},
        });
        let bill = bill(&metadata, "program").unwrap();
        let names: Vec<_> = bill["components"]
            .as_array()
            .unwrap()
            .iter()
            .map(|one| &one["name"])
            .collect();
        assert_eq!(names, ["below", "linked"]);
        assert_eq!(
            bill["metadata"]["component"]["purl"],
            "pkg:cargo/program@1.0.0"
        );
        assert_eq!(
            bill["components"][0]["licenses"][0]["expression"],
            "MIT OR Apache-2.0"
        );
        assert_eq!(
            bill["dependencies"][2],
            json!({"ref": "pkg:cargo/program@1.0.0", "dependsOn": ["pkg:cargo/linked@1.0.0"]})
        );
        assert!(super::bill(&metadata, "missing").is_err());
    }
}
