//! Sphere lists of robot descriptions.
//!
//! A sphere is a mapping with `radius` and `center` (cuRobo) or `origin` (foam). The innermost key above a list of
//! spheres names their link, but for foam's `spheres`, which stands in a link of its own or in one of several levels of
//! detail. Of levels the last, finest one is read.

use super::document::{self, Node, Value};
use super::error::{BallFileErrorKind, Fault};
use super::{BallFile, number};
use crate::ball::{Ball, SMALLEST_RADIUS};

/// Key under which foam lists the spheres of one decomposition.
const FOAM_LIST: &str = "spheres";

/// The spheres under one name.
struct Group {
    name: String,
    balls: Vec<Ball>,
    switched_off: usize,
}

pub(super) fn read(text: &str, wanted: Option<&str>) -> Result<BallFile, Fault> {
    let mut groups: Vec<Group> = Vec::new();
    for document in document::parse(text)? {
        collect(&document, "", &mut groups)?;
    }
    groups.retain(|group| !group.balls.is_empty() || group.switched_off > 0);
    let names: Vec<String> = groups.iter().map(|group| group.name.clone()).collect();
    let known = || names.join(", ");
    let index = match wanted {
        Some(name) => names
            .iter()
            .position(|other| other == name)
            .ok_or_else(|| {
                let name = name.to_owned();
                BallFileErrorKind::Unknown {
                    name,
                    known: known(),
                }
            })?,
        None if names.len() > 1 => return Err(BallFileErrorKind::Several(known()).into()),
        None => 0,
    };
    if groups.is_empty() {
        return Ok(BallFile::default());
    }
    let group = groups.swap_remove(index);
    Ok(BallFile {
        balls: group.balls,
        weights: None,
        group: (!group.name.is_empty()).then_some(group.name),
        groups: names,
        switched_off: group.switched_off,
    })
}

/// Adds the spheres at and below a node to the groups.
fn collect(node: &Node, name: &str, groups: &mut Vec<Group>) -> Result<(), Fault> {
    match &node.value {
        Value::Scalar(_) => Ok(()),
        Value::Mapping(_) if node.get("radius").is_some() => {
            let (ball, line) = (sphere(node)?, node.line);
            if ball.radius > 0.0 && ball.radius < SMALLEST_RADIUS {
                return Err(BallFileErrorKind::Radius(ball.radius).at(line));
            }
            let at = groups.iter().position(|group| group.name == name);
            let at = at.unwrap_or_else(|| {
                groups.push(Group {
                    name: name.to_owned(),
                    balls: Vec::new(),
                    switched_off: 0,
                });
                groups.len() - 1
            });
            if ball.radius > 0.0 {
                groups[at].balls.push(ball);
            } else {
                groups[at].switched_off += 1;
            }
            Ok(())
        }
        Value::Mapping(entries) => {
            for (key, below) in entries {
                let name = if key == FOAM_LIST { name } else { key };
                collect(below, name, groups)?;
            }
            Ok(())
        }
        Value::List(items) => {
            // Levels of detail stand for one another: the last is the finest.
            let are_levels = items.iter().all(|item| item.get(FOAM_LIST).is_some());
            let from = if are_levels {
                items.len().saturating_sub(1)
            } else {
                0
            };
            items[from..]
                .iter()
                .try_for_each(|item| collect(item, name, groups))
        }
    }
}

fn sphere(node: &Node) -> Result<Ball, Fault> {
    let scalar = |node: &Node, what| match &node.value {
        Value::Scalar(text) => {
            number(text).ok_or_else(|| BallFileErrorKind::number(what, text).at(node.line))
        }
        Value::List(_) | Value::Mapping(_) => {
            Err(BallFileErrorKind::number(what, "a list").at(node.line))
        }
    };
    let missing = || BallFileErrorKind::Center.at(node.line);
    let radius = node.get("radius").ok_or_else(missing)?;
    let center = node.get("center").or_else(|| node.get("origin"));
    let Some(Value::List(parts)) = center.map(|center| &center.value) else {
        return Err(missing());
    };
    let [x, y, z] = &parts[..] else {
        return Err(missing());
    };
    Ok(Ball {
        center: [scalar(x, "x")?, scalar(y, "y")?, scalar(z, "z")?],
        radius: scalar(radius, "radius")?,
    })
}
