//! Sphere lists of robot descriptions.
//!
//! A sphere is a mapping with `radius` and `center` (cuRobo) or `origin` (foam). The innermost key above a list of
//! spheres names their link, but for foam's `spheres`, which is in a link or in one of several levels of
//! detail. The last and finest level is read.
//!
//! JSON is read as the YAML that it is.

use saphyr_parser::{Event, Parser};

use super::{BallFile, bad_radius, number_of};
use crate::ball::{Ball, SMALLEST_RADIUS};
use crate::error::Error;

/// Key under which foam lists the spheres of one decomposition.
const FOAM_LIST: &str = "spheres";

struct Group {
    name: String,
    balls: Vec<Ball>,
    switched_off: usize,
}

pub(super) fn read(text: &str, wanted: Option<&str>) -> Result<BallFile, Error> {
    let mut groups: Vec<Group> = Vec::new();
    for document in documents(text)? {
        collect(&document, "", &mut groups)?;
    }
    groups.retain(|group| !group.balls.is_empty() || group.switched_off > 0);
    let names: Vec<String> = groups.iter().map(|group| group.name.clone()).collect();
    let known = names.join(", ");
    let refused =
        |what| Error::input(what).help("name one of them after a colon, as in robot.yml:hand");
    let index = match wanted {
        Some(name) => names
            .iter()
            .position(|other| other == name)
            .ok_or_else(|| {
                refused(format!(
                    "there is no link '{name}' with spheres; there are {known}"
                ))
            })?,
        None if names.len() > 1 => {
            return Err(refused(format!(
                "the file has the spheres of several links, each in its own frame: {known}"
            )));
        }
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
fn collect(node: &Node, name: &str, groups: &mut Vec<Group>) -> Result<(), Error> {
    match &node.value {
        Value::Scalar(_) => Ok(()),
        Value::Mapping(_) if node.get("radius").is_some() => {
            let (ball, line) = (sphere(node)?, node.line);
            if ball.radius > 0.0 && ball.radius < SMALLEST_RADIUS {
                return Err(bad_radius(ball.radius, line));
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

fn sphere(node: &Node) -> Result<Ball, Error> {
    let scalar = |node: &Node, what| match &node.value {
        Value::Scalar(text) => number_of(what, text, node.line),
        Value::List(_) | Value::Mapping(_) => number_of(what, "a list", node.line),
    };
    let missing = || {
        Error::input("the sphere has a radius, but no 'center' or 'origin' of three numbers")
            .on_line(node.line)
            .help("add 'center: [x, y, z]', or remove the sphere")
    };
    let radius = node.get("radius").ok_or_else(missing)?;
    let center = node.get("center").or_else(|| node.get("origin"));
    let Some(Value::List(parts)) = center.map(|center| &center.value) else {
        return Err(missing());
    };
    let [x, y, z] = &parts[..] else {
        return Err(missing());
    };
    Ok(Ball::new(
        [scalar(x, "x")?, scalar(y, "y")?, scalar(z, "z")?],
        scalar(radius, "radius")?,
    ))
}

/// Deepest nesting that is read; lists of spheres have about five levels.
const DEEPEST: usize = 64;

/// A node, and the line that it begins on.
struct Node {
    line: u64,
    value: Value,
}

/// What a node is.
enum Value {
    Scalar(String),
    List(Vec<Node>),
    /// Keys that are no scalars are left out, with their values.
    Mapping(Vec<(String, Node)>),
}

impl Node {
    fn get(&self, key: &str) -> Option<&Node> {
        match &self.value {
            Value::Mapping(entries) => {
                let entry = entries.iter().find(|(name, _)| name == key);
                entry.map(|(_, node)| node)
            }
            Value::Scalar(_) | Value::List(_) => None,
        }
    }
}

fn documents(text: &str) -> Result<Vec<Node>, Error> {
    let mut open: Vec<(Node, Option<Node>)> = Vec::new();
    let mut documents = Vec::new();
    for event in Parser::new_from_str(text) {
        let (event, span) = event.map_err(|error| {
            Error::input(format!(
                "the file is neither YAML nor JSON: {}",
                error.info()
            ))
            .on_line(error.marker().line() as u64)
            .help("correct the syntax at this line")
        })?;
        let line = span.start.line() as u64;
        let value = match event {
            Event::SequenceStart(..) => Value::List(Vec::new()),
            Event::MappingStart(..) => Value::Mapping(Vec::new()),
            Event::Scalar(text, ..) => {
                let value = Value::Scalar(text.into_owned());
                close(&mut open, &mut documents, Node { line, value });
                continue;
            }
            // Lists of spheres have no anchors; what stands for something else holds no ball.
            Event::Alias(_) => {
                let value = Value::Scalar(String::new());
                close(&mut open, &mut documents, Node { line, value });
                continue;
            }
            Event::SequenceEnd | Event::MappingEnd => {
                if let Some((node, _)) = open.pop() {
                    close(&mut open, &mut documents, node);
                }
                continue;
            }
            _ => continue,
        };
        if open.len() == DEEPEST {
            return Err(Error::input(format!(
                "the document is nested more than {DEEPEST} levels deep"
            ))
            .on_line(line)
            .help("keep to the lists of spheres"));
        }
        open.push((Node { line, value }, None));
    }
    Ok(documents)
}

/// Puts a finished node where it belongs: into the collection about it, as a key or under the key before it.
fn close(open: &mut [(Node, Option<Node>)], documents: &mut Vec<Node>, node: Node) {
    match open.last_mut() {
        None => documents.push(node),
        Some((about, key)) => match &mut about.value {
            Value::List(items) => items.push(node),
            Value::Mapping(entries) => match key.take() {
                None => *key = Some(node),
                Some(Node {
                    value: Value::Scalar(name),
                    ..
                }) => entries.push((name, node)),
                Some(_) => {}
            },
            Value::Scalar(_) => {}
        },
    }
}
