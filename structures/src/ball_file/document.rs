//! YAML and JSON as a tree of nodes with lines. JSON is read as the YAML that it is.

use saphyr_parser::{Event, Parser};

use super::error::{BallFileErrorKind, Fault};

/// Deepest nesting that is read; lists of spheres have about five levels.
const DEEPEST: usize = 64;

/// A node, and the line that it begins on.
pub(super) struct Node {
    pub line: usize,
    pub value: Value,
}

/// What a node is.
pub(super) enum Value {
    Scalar(String),
    List(Vec<Node>),
    /// Keys that are no scalars are left out, with their values.
    Mapping(Vec<(String, Node)>),
}

impl Node {
    /// The value under a key of a mapping.
    pub fn get(&self, key: &str) -> Option<&Node> {
        match &self.value {
            Value::Mapping(entries) => {
                let entry = entries.iter().find(|(name, _)| name == key);
                entry.map(|(_, node)| node)
            }
            Value::Scalar(_) | Value::List(_) => None,
        }
    }
}

/// The documents of a text.
pub(super) fn parse(text: &str) -> Result<Vec<Node>, Fault> {
    let mut open: Vec<(Node, Option<Node>)> = Vec::new();
    let mut documents = Vec::new();
    for event in Parser::new_from_str(text) {
        let (event, span) = event.map_err(|error| {
            BallFileErrorKind::Syntax(error.info().to_owned()).at(error.marker().line())
        })?;
        let line = span.start.line();
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
            return Err(BallFileErrorKind::Deep(DEEPEST).at(line));
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
