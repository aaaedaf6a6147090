use super::*;

fn read(name: &str, text: &str) -> Result<BallFile, Error> {
    parse(Path::new(name), text.as_bytes(), None)
}

fn ball(x: f64, y: f64, z: f64, radius: f64) -> Ball {
    Ball::new([x, y, z], radius)
}

#[test]
fn tables_with_and_without_a_header() {
    let expected = [ball(1.0, -2.0, 3e-7, 0.5), ball(0.0, 0.0, 0.0, 2.0)];
    for text in [
        "x,y,z,r,weight\n1,-2,3e-7,0.5,1\n0,0,0,2,0.25\n",
        "weight;R;Z;Y;X\n1;0.5;3e-7;-2;1\n0.25;2;0;0;0\n",
        "1,-2,3e-7,0.5,1\n\n# a remark\n0,0,0,2,0.25",
        "\u{feff}x\ty\tz\tradius\tweight\r\n1\t-2\t3e-7\t0.5\t1\r\n0\t0\t0\t2\t0.25\r\n",
    ] {
        let file = read("a.csv", text).unwrap();
        assert_eq!(file.balls, expected, "{text}");
        assert_eq!(file.weights, Some(vec![1.0, 0.25]));
    }
    let file = read("a.CSV", "1, -2, 3e-7, 0.5\n0,0,0,2").unwrap();
    assert_eq!((file.balls.as_slice(), file.weights), (&expected[..], None));
}

#[test]
fn faults_of_tables_name_their_line() {
    for (text, line, kind) in [
        ("", None, "no balls"),
        ("x,y,z,r\n", None, "no balls"),
        ("x,y,r\n1,2,3\n", Some(1), "no column 'z'"),
        ("1,2,3,4\n\n1,2,3\n", Some(3), "3 fields, not 4"),
        ("1,2,3\n", Some(1), "3 fields, not 4"),
        ("x,y,z,r\n1,2,nan,4\n", Some(2), "z is 'nan'"),
        ("x,y,z,r\n1,2,3,4\n1,2,3,\n", Some(3), "r is ''"),
        ("x,y,z,r\n1,2,3,0\n", Some(2), "the radius is 0.0"),
        ("1,2,3,4,-1\n", Some(1), "the weight is -1"),
    ] {
        let error = read("a.csv", text).unwrap_err();
        assert_eq!(error.line(), line, "{text}");
        assert!(error.message().contains(kind), "{text}: {error}");
        assert!(error.remedy().is_some() && error.file() == Some(Path::new("a.csv")));
    }
    let error = parse(Path::new("a.csv"), b"\xff\xfe", None).unwrap_err();
    assert!(error.message().contains("UTF-8"));
    assert!(read("a.txt", "").unwrap_err().message().contains("ending"));
    assert!(is_ball_file(Path::new("x.YML")) && !is_ball_file(Path::new("x.stl")));
}

const CUROBO: &str = "\
collision_spheres:
  base:
    - \"center\": [0.0, 0.0, 0.05]
      \"radius\": 0.08
    - center:
      - 0.1
      - 0
      - 0
      radius: 0.02
  attached_object:
    - {center: [0, 0, 0], radius: -10.0}
";

#[test]
fn links_of_a_robot() {
    let error = read("robot.yml", CUROBO).unwrap_err();
    assert!(
        error
            .message()
            .contains("several links, each in its own frame: base, attached_object")
    );
    let pick = |name| parse(Path::new("robot.yml"), CUROBO.as_bytes(), Some(name));
    let base = pick("base").unwrap();
    assert_eq!(
        base.balls,
        [ball(0.0, 0.0, 0.05, 0.08), ball(0.1, 0.0, 0.0, 0.02)]
    );
    assert_eq!(base.group.as_deref(), Some("base"));
    // Every sphere of this one is switched off.
    let error = pick("attached_object").unwrap_err();
    assert!(error.message().contains("no balls"));
    let error = pick("hand").unwrap_err();
    assert!(error.to_string().contains("base, attached_object"));
}

#[test]
fn levels_of_detail_of_foam() {
    let text = r#"[{"mean": 1, "best": 0, "worst": 2, "spheres": [{"origin": [9, 9, 9], "radius": 9}]},
        {"mean": 0.1, "spheres": [{"origin": [1.0, 2.0, 3.0], "radius": 0.5}, {"origin": [0, 0, 0], "radius": 1e-3}]}]"#;
    let file = read("bunny-spheres.json", text).unwrap();
    assert_eq!(
        file.balls,
        [ball(1.0, 2.0, 3.0, 0.5), ball(0.0, 0.0, 0.0, 1e-3)]
    );
    assert_eq!(file.group, None);
    let links = r#"{"one": [{"origin": [0, 0, 1], "radius": 1}], "two": {"spheres": [{"origin": [0, 0, 2], "radius": 2}]}}"#;
    let two = parse(Path::new("a.json"), links.as_bytes(), Some("two")).unwrap();
    assert_eq!(two.balls, [ball(0.0, 0.0, 2.0, 2.0)]);
}

#[test]
fn faults_of_documents_name_their_line() {
    let deep = "- ".repeat(100_000);
    for (text, line, kind) in [
        ("a:\n  - radius: 1\n", Some(2), "no 'center'"),
        (
            "a:\n  - radius: x\n    center: [0, 0, 0]\n",
            Some(2),
            "radius is 'x'",
        ),
        (
            "a:\n  - radius: 1\n    center: [0, .inf, 0]\n",
            Some(3),
            "y is '.inf'",
        ),
        (
            "a:\n  - radius: 1\n    center: [0, 0]\n",
            Some(2),
            "no 'center'",
        ),
        ("just: text\n", None, "no balls"),
        (deep.as_str(), Some(1), "64 levels"),
    ] {
        let error = read("a.yaml", text).unwrap_err();
        let start = &text[..text.len().min(80)];
        assert_eq!(error.line(), line, "{start}");
        assert!(error.message().contains(kind), "{start}: {error}");
    }
    for text in ["{\"a\": [1, 2}\n", &"[".repeat(1_000_000)] {
        let error = read("a.json", text).unwrap_err();
        assert!(error.message().contains("neither YAML nor JSON") && error.line().is_some());
    }
}
