//! Makes the bindings from the installed cargobay.h, with the commands `pkg-config` and `bindgen`
//! (Debian: pkg-config, bindgen), and links libcargobay.so.

use std::path::{Path, PathBuf};
use std::process::{exit, Command};
use std::{env, fs, io};

/// The standard output of a command; the build ends if it fails.
fn output(command: &mut Command) -> String {
    let program = command.get_program().to_string_lossy().into_owned();
    match command.output() {
        Ok(done) if done.status.success() => {
            return String::from_utf8_lossy(&done.stdout).into_owned();
        }
        Ok(done) => eprintln!("{program}: {}", String::from_utf8_lossy(&done.stderr)),
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            eprintln!("{program} is missing: apt-get install {program}");
        }
        Err(error) => eprintln!("{program}: {error}"),
    }
    exit(1);
}

fn pkg_config(what: &str) -> Vec<String> {
    let words = output(Command::new("pkg-config").args([what, "cargobay"]));
    words.split_whitespace().map(str::to_owned).collect()
}

fn main() {
    let out_dir = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets it"));
    let flags = pkg_config("--cflags");
    let header = out_dir.join("all.h");
    fs::write(&header, "#include <cargobay.h>\n").expect("OUT_DIR is writable");
    output(
        Command::new("bindgen")
            .args(["--no-prepend-enum-name", "--no-doc-comments"])
            .args(["--with-derive-default"])
            .args(["--allowlist-function", "cargobay_.*"])
            .args(["--allowlist-type", "cargobay_.*"])
            .args(["--allowlist-var", "CARGOBAY_.*"])
            .arg("--output")
            .arg(out_dir.join("bindings.rs"))
            .arg(&header)
            .arg("--")
            .args(&flags),
    );

    for word in pkg_config("--libs") {
        if let Some(folder) = word.strip_prefix("-L") {
            println!("cargo:rustc-link-search=native={folder}");
            // Not a folder of the system, so the loader would not look there.
            println!("cargo:rustc-link-arg=-Wl,-rpath,{folder}");
        } else if let Some(library) = word.strip_prefix("-l") {
            println!("cargo:rustc-link-lib=dylib={library}");
        }
    }
    let folders = flags.iter().filter_map(|word| word.strip_prefix("-I"));
    for folder in folders.chain(["/usr/include"]) {
        let header = Path::new(folder).join("cargobay.h");
        if header.exists() {
            println!("cargo:rerun-if-changed={}", header.display());
        }
    }
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-env-changed=PKG_CONFIG_PATH");
}
