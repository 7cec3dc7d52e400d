//! Files of points: written, read back, and broken in every way.

use std::fs;
use std::path::{Path, PathBuf};

use handeye::geometry::Vec3;
use handeye::scan::Cloud;
use handeye::scan::files::{CloudFileError, CloudFormat, read_cloud, write_cloud};
use handeye::watch::{Cancelled, Unwatched, Watch};

/// Five decimals in text, and 32 bits about the origin.
const WITHIN_MM: f64 = 2e-4;

fn cloud() -> Cloud {
    let mut cloud = Cloud::about(Vec3::new(800.0, -300.0, 150.0));
    for idx in 0..1000_u32 {
        let t = f64::from(idx) / 100.0;
        cloud.push(Vec3::new(800.0 + 30.0 * t.sin(), -300.0 + 5.0 * t, 150.0 + t.cos()), idx / 50).expect("room");
    }
    cloud
}

#[test]
fn what_is_written_is_read_back() {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, format) in [("a.ply", CloudFormat::Ply), ("b.ply", CloudFormat::PlyText), ("c.csv", CloudFormat::Csv)] {
        let path = folder.path().join(name);
        fs::write(&path, "older").expect("written");
        let written = cloud();
        write_cloud(&written, &path, format, &mut Unwatched).expect("written");
        let read = read_cloud(&path, &mut Unwatched).expect("readable");
        assert_eq!((read.cloud.len(), read.num_left_out), (written.len(), 0), "{name}");
        assert_eq!(read.cloud.profile_idx(), written.profile_idx());
        for idx in 0..written.len() {
            assert!((read.cloud.point_mm(idx) - written.point_mm(idx)).amax() < WITHIN_MM, "{name}, {idx}");
        }
        // The same again gives the same bytes.
        let again = folder.path().join(format!("again-{name}"));
        write_cloud(&read.cloud, &again, format, &mut Unwatched).expect("written");
        if format != CloudFormat::Ply {
            assert_eq!(fs::read(&path).expect("readable"), fs::read(&again).expect("readable"), "{name}");
        }
    }
    let left: Vec<_> =
        fs::read_dir(folder.path()).expect("readable").flatten().map(|entry| entry.file_name()).collect();
    assert_eq!(left.len(), 6, "no temporary file is left: {left:?}");
}

struct Never;

impl Watch for Never {
    fn report(&mut self, _: usize, _: usize) -> Result<(), Cancelled> {
        Err(Cancelled)
    }
}

#[test]
fn a_cancelled_export_leaves_the_older_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.ply");
    fs::write(&path, "older").expect("written");
    let outcome = write_cloud(&cloud(), &path, CloudFormat::Ply, &mut Never);
    assert!(matches!(outcome, Err(CloudFileError::Cancelled(_))));
    assert_eq!(fs::read_to_string(&path).expect("readable"), "older");
    assert_eq!(fs::read_dir(folder.path()).expect("readable").count(), 1);
}

fn file(folder: &Path, name: &str, bytes: &[u8]) -> PathBuf {
    let path = folder.join(name);
    fs::write(&path, bytes).expect("written");
    path
}

const HEAD: &str = "property float x\nproperty float y\nproperty float z\nend_header\n";

#[test]
fn files_of_other_programs_are_read() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut big_endian =
        format!("ply\r\nformat binary_big_endian 1.0\r\nelement camera 1\nproperty uchar id\nelement vertex 2\n{HEAD}")
            .into_bytes();
    big_endian.push(7);
    for value in [1.5_f32, 2.0, -3.0, f32::NAN, 0.0, 0.0] {
        big_endian.extend(value.to_be_bytes());
    }
    let colored = "ply\nformat ascii 1.0\ncomment made elsewhere\nelement vertex 2\nproperty uchar red\nproperty double z\n\
                   property double x\nproperty double y\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
                   255 -3 1.5 2\n0 1 2 3\n3 0 1 1\n";
    for (name, bytes, num_points, num_left_out) in [
        ("a.ply", big_endian.as_slice(), 1, 1),
        ("b.ply", colored.as_bytes(), 2, 0),
        ("c.xyz", b"1.5 2 -3 255 0 0\n 4  5 6\n", 2, 0),
        ("d.csv", "\u{feff}Name;X_mm;Y_mm;Z_mm\na;1.5;2;-3\nb;4;5;6\n".as_bytes(), 2, 0),
        ("e.txt", b"# a comment\n// another\n1.5, 2, -3\n", 1, 0),
        ("f.xyz", b"1.5\t2\t-3\nnan\tnan\tnan\n", 1, 1),
    ] {
        let read = read_cloud(&file(folder.path(), name, bytes), &mut Unwatched).expect(name);
        assert_eq!((read.cloud.len(), read.num_left_out), (num_points, num_left_out), "{name}");
        assert!((read.cloud.point_mm(0) - Vec3::new(1.5, 2.0, -3.0)).amax() < WITHIN_MM, "{name}");
    }
}

#[test]
fn broken_files_are_refused_with_place_found_and_expected() {
    let folder = tempfile::tempdir().expect("a folder");
    let ply =
        |format: &str, num: &str, body: &str| format!("ply\nformat {format} 1.0\nelement vertex {num}\n{HEAD}{body}");
    let checks: [(&str, String, &[&str]); 17] = [
        ("empty.ply", String::new(), &["no point"]),
        ("header.ply", "ply\nformat ascii 1.0\n".to_owned(), &["line", "end of the file", "end_header"]),
        ("nonsense.ply", "ply\nnonsense here\n".to_owned(), &["line 2", "nonsense", "format, element"]),
        ("format.ply", ply("quantum", "1", ""), &["line 2", "quantum", "binary_little_endian"]),
        ("count.ply", ply("ascii", "-4", ""), &["line 3", "-4", "a number"]),
        // As many as no memory holds, and nothing set aside for them.
        (
            "promise.ply",
            ply("binary_little_endian", "18000000000000000000", "abc"),
            &["byte", "3 bytes", "header says"],
        ),
        ("short.ply", ply("binary_little_endian", "3", "twelve bytes"), &["byte", "12 bytes for 3 vertex"]),
        ("text.ply", ply("ascii", "99999999999", "1 2 3\n"), &["line 9", "after 1 of 99999999999"]),
        ("word.ply", ply("ascii", "2", "1 2 3\n1 two 3\n"), &["line 9", "two", "3 numbers"]),
        ("few.ply", ply("ascii", "1", "1 2\n"), &["line 8", "3 numbers"]),
        (
            "list.ply",
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty list uchar int x\nend_header\n".to_owned(),
            &["a list", "vertices"],
        ),
        (
            "axis.ply",
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nend_header\n1 2\n".to_owned(),
            &["without z"],
        ),
        ("none.ply", "ply\nformat ascii 1.0\nend_header\n".to_owned(), &["without vertices", "element vertex"]),
        ("words.csv", "alpha,beta,gamma\n1,2,3\n".to_owned(), &["line 1", "alpha", "three numbers"]),
        ("short.xyz", "1 2 3\n4 5\n".to_owned(), &["line 2", "4 5", "three numbers"]),
        ("far.xyz", "1 2 3\n4 5 1e9\n".to_owned(), &["line 2", "100 m"]),
        ("infinite.xyz", "inf 2 3\n".to_owned(), &["line 1", "100 m"]),
    ];
    for (name, text, fragments) in checks {
        let refusal =
            read_cloud(&file(folder.path(), name, text.as_bytes()), &mut Unwatched).expect_err(name).to_string();
        assert!(refusal.contains(name), "{refusal}");
        for fragment in fragments {
            assert!(refusal.contains(fragment), "{name}: {fragment:?} is not in {refusal:?}");
        }
    }
    let endless = vec![b'1'; 1 << 20];
    let refusal = read_cloud(&file(folder.path(), "endless.xyz", &endless), &mut Unwatched).expect_err("no line");
    assert!(refusal.to_string().contains("a line of more than"), "{refusal}");
    let refusal = read_cloud(&file(folder.path(), "bytes.xyz", &[0xff, 0xfe, 0, 1]), &mut Unwatched);
    assert!(matches!(refusal, Err(CloudFileError::Line { line: 1, .. })));
    assert!(matches!(read_cloud(folder.path(), &mut Unwatched), Err(CloudFileError::Unreadable { .. })));
    assert!(matches!(CloudFormat::of(Path::new("a.stl")), Err(CloudFileError::UnknownEnding { .. })));
}

#[test]
fn no_damage_to_a_file_panics() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.ply");
    for format in [CloudFormat::Ply, CloudFormat::PlyText, CloudFormat::Csv] {
        write_cloud(&cloud(), &path, format, &mut Unwatched).expect("written");
        let whole = fs::read(&path).expect("readable");
        for place in (0..whole.len().min(600)).step_by(7) {
            let mut bytes = whole.clone();
            bytes[place] = bytes[place].wrapping_add(u8::try_from(1 + place % 90).expect("small"));
            read_cloud(&file(folder.path(), "damaged.ply", &bytes), &mut Unwatched).ok();
            read_cloud(&file(folder.path(), "cut.ply", &whole[..place]), &mut Unwatched).ok();
        }
    }
}
