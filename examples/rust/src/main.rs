//! Drives ahead for two seconds and says how far it came. Without a port: a virtual Create, in
//! virtual time.

use cargobay::{Error, Robot, VirtualCreate};
use std::process::ExitCode;

fn drive_ahead(mut robot: Robot) -> Result<(), Error> {
    robot.start()?;
    let mut tick = -1;
    while let Some(state) = robot.wait(tick, None)? {
        if state.robot_time_ns >= 2_000_000_000 {
            println!("{:.0} mm ahead after {} frames", state.x_mm, state.tick);
            break;
        }
        tick = state.tick;
        robot.drive(200.0, 0.0)?;
    }
    robot.end()
}

fn run() -> Result<(), Error> {
    match std::env::args().nth(1) {
        Some(port) => drive_ahead(Robot::open(&port)?),
        None => drive_ahead(Robot::on(&VirtualCreate::open()?)?),
    }
}

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}
