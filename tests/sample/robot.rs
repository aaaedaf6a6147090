//! `--robot`: spheres that cover the links of a robot.

use std::f64::consts::PI;

use knotdock_structures::{Ball, ball_file};

use super::*;

/// A link by a mesh and a sphere, one by a cylinder, one by a box and one without geometry. The names need quotes, and
/// escapes in XML.
const ROBOT: &str = r#"<?xml version="1.0"?>
<robot name="r">
  <link name="base: &quot;1&quot; &lt;a>">
    <visual><geometry><mesh filename="looks.dae"/></geometry></visual>
    <collision>
      <origin xyz="1 2 3" rpy="0 0 1.5707963267948966"/>
      <geometry><mesh filename="package://place/box.obj" scale="-0.5 1 2"/></geometry>
    </collision>
    <collision><origin xyz="0 0 9"/><geometry><sphere radius="0.25"/></geometry></collision>
  </link>
  <link name="arm"><collision><origin rpy="1.5707963267948966 0 0"/>
    <geometry><cylinder radius="0.1" length="2"/></geometry></collision></link>
  <link name="hand"><collision><geometry><box size="0.2 0.1 0.4"/></geometry></collision></link>
  <link name="tool"/>
</robot>
"#;

const LINKS: [&str; 3] = ["base: \"1\" <a>", "arm", "hand"];

/// Points of the surfaces of the three links, computed by hand.
fn surfaces() -> [Vec<[f64; 3]>; 3] {
    let mut points: [Vec<[f64; 3]>; 3] = Default::default();
    for corner in 0..8 {
        let [x, y, z] = [0, 1, 2].map(|axis| f64::from(corner >> axis & 1));
        // The box from 0 to 4, 2, 1 becomes one to -2, 2, 2, turns x to y and y to -x, and moves.
        points[0].push([1.0 - 2.0 * y, 2.0 - 2.0 * x, 3.0 + 2.0 * z]);
        points[2].push([0.2 * (x - 0.5), 0.1 * (y - 0.5), 0.4 * (z - 0.5)]);
    }
    points[0].extend([[0.25, 0.0, 9.0], [0.0, 0.0, 8.75]]);
    for step in 0..200 {
        // The axis of the cylinder turns from z to -y.
        let angle = 2.0 * PI * f64::from(step) / 200.0;
        for y in [-1.0, 0.1, 1.0] {
            points[1].push([0.1 * angle.cos(), y, 0.1 * angle.sin()]);
        }
    }
    points
}

/// The place of the robot: a package whose folder is above its file.
fn robot() -> Place {
    let place = Place::new();
    let package = place.path("place");
    fs::create_dir_all(package.join("urdf")).unwrap();
    fs::write(package.join("box.obj"), box_obj()).unwrap();
    fs::write(package.join("urdf/robot.urdf"), ROBOT).unwrap();
    place
}

fn spheres(place: &Place, file: &str, link: &str) -> Vec<Ball> {
    let path = place.path(file);
    let bytes = fs::read(&path).unwrap();
    ball_file::parse(&path, &bytes, Some(link)).unwrap().balls
}

fn gap(ball: &Ball, point: [f64; 3]) -> f64 {
    let square = (0..3).map(|axis| (ball.center[axis] - point[axis]).powi(2));
    square.sum::<f64>().sqrt() - ball.radius
}

#[test]
fn spheres_cover_each_link_in_every_format() {
    let place = robot();
    let urdf = "place/urdf/robot.urdf";
    let arguments = |format, file| [urdf, "--grid", "2^12", "--robot", format, "-o", file];
    let curobo = place.sample(&arguments("curobo", "spheres.yml"));
    let foam = place.sample(&arguments("foam", "spheres.json"));
    place.sample(&arguments("urdf", "place/urdf/spheres.urdf"));
    // The spheres of the file written are read again as what they are.
    let again = [
        "place/urdf/spheres.urdf",
        "--robot",
        "curobo",
        "-o",
        "again.yml",
    ];
    let again = place.sample(&again);
    for (index, (link, points)) in LINKS.iter().zip(surfaces()).enumerate() {
        let balls = spheres(&place, "spheres.yml", link);
        for point in points {
            let nearest = balls.iter().map(|ball| gap(ball, point));
            let nearest = nearest.fold(f64::INFINITY, f64::min);
            assert!(nearest <= 0.0, "{link}: {point:?} is {nearest} outside");
        }
        assert_eq!(balls, spheres(&place, "spheres.json", link));
        assert_eq!(balls, spheres(&place, "again.yml", link));
        for object in [&curobo, &foam] {
            assert_eq!(object["links"][index]["link"], *link);
            assert_eq!(object["links"][index]["covered"], "proven");
            assert_eq!(object["links"][index]["spheres"], balls.len());
        }
        assert_eq!(again["links"][index]["reach"], 0.0);
    }
    assert_eq!(curobo["links"].as_array().unwrap().len(), 3);
    // No sphere of the hand reaches farther beyond its box than is written.
    let reach = curobo["links"][2]["reach"].as_f64().unwrap();
    assert!(reach > 0.0 && reach < 0.05, "{reach}");
    for ball in spheres(&place, "spheres.yml", "hand") {
        let out = [0.1, 0.05, 0.2].iter().zip(ball.center);
        let out = out.map(|(half, part)| part.abs() + ball.radius - half);
        assert!(out.fold(0.0, f64::max) <= reach + 1e-12, "{ball:?}");
    }
    let text = fs::read_to_string(place.path("spheres.yml")).unwrap();
    assert!(text.contains(&format!("farther than {reach}")), "{text}");
    let text = fs::read_to_string(place.path("place/urdf/spheres.urdf")).unwrap();
    assert!(text.contains("looks.dae") && !text.contains("cylinder"));
    assert!(text.contains(&format!("farther than {reach}")), "{text}");
}

/// A level of few spheres still covers, and its file says what it costs.
#[test]
fn few_spheres_cover_too() {
    let place = robot();
    let urdf = "place/urdf/robot.urdf";
    let object = place.sample(&[urdf, "--grid", "2^12", "--robot", "curobo", "--level", "5"]);
    for (index, (link, points)) in LINKS.iter().zip(surfaces()).enumerate() {
        assert_eq!(object["links"][index]["spheres"], 5);
        let balls = spheres(&place, "spheres.yml", link);
        let covers = |&point: &[f64; 3]| balls.iter().any(|ball| gap(ball, point) <= 0.0);
        assert!(points.iter().all(covers), "{link}");
    }
}

#[test]
fn robots_that_cannot_be_covered_are_refused() {
    let place = robot();
    let refused = |from: &str, to: &str, message: &str| {
        let text = ROBOT.replacen(from, to, 1);
        assert_ne!(text, ROBOT);
        fs::write(place.path("place/bad.urdf"), text).unwrap();
        let error = place.refused(&["place/bad.urdf", "--robot", "curobo", "--grid", "2^9"]);
        assert!(
            error["message"].as_str().unwrap().contains(message),
            "{error}"
        );
        assert_eq!(error["file"], "place/bad.urdf");
        error
    };
    let error = refused("box.obj", "gone.obj", "no mesh 'package://place/gone.obj'");
    assert_eq!(error["line"], 7);
    fs::write(place.path("place/box.dae"), "").unwrap();
    refused("box.obj", "box.dae", "is no mesh that is read");
    refused("<box size=\"0.2 0.1 0.4\"/>", "<capsule/>", "'capsule'");
    refused("0.2 0.1 0.4", "0.2 0.1", "three numbers");
    refused("0.2 0.1 0.4", "0.2 0.1 0", "above zero");
    refused("0.2 0.1 0.4", "0.2 0.1 nan", "three numbers");
    refused("-0.5 1 2", "0 1 2", "scale");
    refused("radius=\"0.1\"", "radius=\"0\"", "radius");
    refused("name=\"hand\"", "name=\"arm\"", "two links 'arm'");
    refused("</robot>", "", "not XML");
    refused("<robot name=\"r\">", "<machine>", "not XML");
    fs::write(
        place.path("empty.urdf"),
        "<robot name='r'><link name='a'/></robot>",
    )
    .unwrap();
    let error = place.refused(&["empty.urdf", "--robot", "urdf"]);
    assert!(error["message"].as_str().unwrap().contains("no link"));
    place.refused(&["place/urdf/robot.urdf", "--robot", "foam", "--set", "a1"]);
    place.refused(&["place/urdf/robot.urdf"]);
    place.refused(&[
        "place/urdf/robot.urdf",
        "--robot",
        "urdf",
        "-o",
        "place/urdf/robot.urdf",
        "--force",
    ]);
}
