//! Files of balls named on the command line: read, recorded, described.

use std::path::Path;

use knotdock::bounded_read::{MAX_TABLE, read_bounded};
use knotdock::output::records::input_record::InputRecord;
use knotdock_structures::ball_file::{self, BallFile};
use knotdock_structures::molecule::InputSpec;

use knotdock_structures::Error;

/// A file of balls as read.
pub struct BallFileInput {
    /// File, link and checksum.
    pub record: InputRecord,
    /// Its balls.
    pub file: BallFile,
}

impl BallFileInput {
    /// Reads the balls of a file; of one with links those of the link that stands in the place of a chain.
    pub fn read(spec: &InputSpec) -> Result<Self, Error> {
        let bytes = read_bounded(&spec.path, MAX_TABLE).map_err(|error| {
            Error::input(format!("cannot read the balls: {error}"))
                .at(&spec.path)
                .help("check the name, the permissions and the size of the file")
        })?;
        let link = spec.chains.as_ref().and_then(|chains| chains.first());
        Ok(Self {
            record: InputRecord::new(spec, &bytes),
            file: ball_file::parse(&spec.path, &bytes, link.map(String::as_str))?,
        })
    }

    /// What was read, in words.
    pub fn report(&self) -> String {
        let count = self.file.balls.len();
        let balls = if count == 1 { "ball" } else { "balls" };
        match &self.file.group {
            Some(link) => format!("{count} {balls} of {link}"),
            None => format!("{count} {balls}"),
        }
    }

    /// What to know before relying on it.
    pub fn warnings(&self) -> Vec<String> {
        let count = self.file.switched_off;
        let off = (count > 0).then(|| {
            format!(
                "left out {count} spheres whose radius is not above zero, by which they are switched off"
            )
        });
        off.into_iter().collect()
    }
}

/// The file of balls that a text names, with the link picked of it; `None` where it names something else.
pub fn ball_file_of(text: &str) -> Option<InputSpec> {
    if ball_file::is_ball_file(Path::new(text)) {
        return Some(InputSpec::whole(text));
    }
    let (path, link) = text.rsplit_once(':')?;
    let is_of_balls = ball_file::is_ball_file(Path::new(path)) && !link.is_empty();
    is_of_balls.then(|| InputSpec {
        chains: Some(vec![link.to_owned()]),
        ..InputSpec::whole(path)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_balls_are_known_by_their_names() {
        let found =
            |text| ball_file_of(text).map(|spec| (spec.path.display().to_string(), spec.chains));
        assert_eq!(found("a/knots.csv"), Some(("a/knots.csv".into(), None)));
        let hand = ("robot.yml".to_owned(), Some(vec!["hand".to_owned()]));
        assert_eq!(found("robot.yml:hand"), Some(hand));
        assert_eq!(found("robot.yml:"), None);
        assert_eq!(found("molecule.pdb:A"), None);
        assert_eq!(found("part.stl"), None);
    }
}
