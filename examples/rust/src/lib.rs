//! A thin, safe layer over libcargobay: what a program needs to drive. The rest of the C API is in
//! [`ffi`], with the handles that [`Robot::handle`] and [`VirtualCreate::handle`] give.

use std::ffi::{CStr, CString};
use std::marker::PhantomData;
use std::os::raw::{c_char, c_int};
use std::time::Duration;
use std::{fmt, mem, ptr};

/// cargobay.h as bindgen sees it.
#[allow(non_camel_case_types, clippy::all)]
pub mod ffi {
    include!(concat!(env!("OUT_DIR"), "/bindings.rs"));
}

/// The state of the loop at one tick.
pub type State = ffi::cargobay_state;
/// What really happens to a virtual Create.
pub type Truth = ffi::cargobay_truth;

/// Why a call failed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Error {
    /// One of `ffi::CARGOBAY_E_...`: what to do about it.
    pub code: i32,
    /// One line for a person.
    pub message: String,
}

impl Error {
    /// The name of the code, as "CARGOBAY_E_BUSY".
    pub fn name(&self) -> &'static str {
        // Safe: any number may be passed, and the text is never freed.
        let name = unsafe { CStr::from_ptr(ffi::cargobay_error_name(self.code)) };
        name.to_str().unwrap_or("")
    }
}

impl fmt::Display for Error {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        write!(formatter, "{} ({})", self.message, self.name())
    }
}

impl std::error::Error for Error {}

/// What a function returned, with the message of this thread if it failed.
fn check(result: c_int) -> Result<c_int, Error> {
    if result >= 0 {
        return Ok(result);
    }
    // Safe: the text lives until the next failed call on this thread.
    let message = unsafe { CStr::from_ptr(ffi::cargobay_error_message()) };
    Err(Error {
        code: result,
        message: message.to_string_lossy().into_owned(),
    })
}

fn size_of<T>() -> u32 {
    mem::size_of::<T>() as u32
}

/// A virtual Create in virtual time: every run is the same, and takes a moment.
#[derive(Debug)]
pub struct VirtualCreate {
    handle: *mut ffi::cargobay_sim,
}

impl VirtualCreate {
    pub fn open() -> Result<Self, Error> {
        let options = ffi::cargobay_sim_options {
            size: size_of::<ffi::cargobay_sim_options>(),
            time: ffi::CARGOBAY_SIM_TIME_VIRTUAL as i32,
            ..Default::default()
        };
        let mut handle = ptr::null_mut();
        check(unsafe { ffi::cargobay_sim_open(&options, &mut handle) })?;
        Ok(Self { handle })
    }

    pub fn truth(&self) -> Result<Truth, Error> {
        let mut truth = Truth {
            size: size_of::<Truth>(),
            ..Default::default()
        };
        check(unsafe { ffi::cargobay_sim_get_truth(self.handle, &mut truth) })?;
        Ok(truth)
    }

    pub fn handle(&self) -> *mut ffi::cargobay_sim {
        self.handle
    }
}

impl Drop for VirtualCreate {
    fn drop(&mut self) {
        // The robot that borrows it is gone, so this cannot fail.
        unsafe { ffi::cargobay_sim_close(self.handle) };
    }
}

/// A robot. It belongs to one thread, as in virtual time it must.
#[derive(Debug)]
pub struct Robot<'sim> {
    handle: *mut ffi::cargobay_robot,
    sim: PhantomData<&'sim VirtualCreate>,
}

impl Robot<'static> {
    /// Opens the robot behind a serial port.
    pub fn open(port: &str) -> Result<Self, Error> {
        let port = CString::new(port).map_err(|error| Error {
            code: ffi::CARGOBAY_E_ARGUMENT,
            message: format!("port: {error}"),
        })?;
        Self::open_with(port.as_ptr(), ptr::null_mut())
    }
}

impl<'sim> Robot<'sim> {
    /// Opens a virtual Create, which outlives the robot.
    pub fn on(create: &'sim VirtualCreate) -> Result<Self, Error> {
        Self::open_with(ptr::null(), create.handle)
    }

    fn open_with(port: *const c_char, sim: *mut ffi::cargobay_sim) -> Result<Self, Error> {
        let options = ffi::cargobay_options {
            size: size_of::<ffi::cargobay_options>(),
            port,
            sim,
            ..Default::default()
        };
        let mut handle = ptr::null_mut();
        check(unsafe { ffi::cargobay_open(&options, &mut handle) })?;
        Ok(Self {
            handle,
            sim: PhantomData,
        })
    }

    pub fn start(&mut self) -> Result<(), Error> {
        check(unsafe { ffi::cargobay_start(self.handle) }).map(drop)
    }

    /// Ends the loop; the robot is stopped, in Passive mode.
    pub fn end(&mut self) -> Result<(), Error> {
        check(unsafe { ffi::cargobay_end(self.handle) }).map(drop)
    }

    /// Waits for a state newer than `after_tick`; -1: any. Without a timeout: for ever. `None`: no
    /// more will come, because the loop ended as asked.
    pub fn wait(&self, after_tick: i64, timeout: Option<Duration>) -> Result<Option<State>, Error> {
        let timeout_ns = timeout.map_or(-1, |time| {
            i64::try_from(time.as_nanos()).unwrap_or(i64::MAX)
        });
        let mut state = State {
            size: size_of::<State>(),
            ..Default::default()
        };
        let result =
            check(unsafe { ffi::cargobay_wait(self.handle, after_tick, timeout_ns, &mut state) })?;
        Ok((result == 0).then_some(state))
    }

    /// Sets velocity and turn rate until the next call, but for half a second at most.
    pub fn drive(&self, velocity_mm_s: f64, turn_rate_rad_s: f64) -> Result<(), Error> {
        check(unsafe { ffi::cargobay_drive(self.handle, velocity_mm_s, turn_rate_rad_s) }).map(drop)
    }

    pub fn handle(&self) -> *mut ffi::cargobay_robot {
        self.handle
    }
}

impl Drop for Robot<'_> {
    fn drop(&mut self) {
        // If a control function hangs the robot was stopped all the same: nobody to tell.
        unsafe { ffi::cargobay_close(self.handle) };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_port_that_does_not_exist_is_an_error_with_a_remedy() {
        let error = Robot::open("/dev/no_robot_here").unwrap_err();
        assert_eq!(error.code, ffi::CARGOBAY_E_NO_PORT);
        assert_eq!(error.name(), "CARGOBAY_E_NO_PORT");
        assert!(error.message.contains("/dev/no_robot_here"), "{error}");
        assert_eq!(
            Robot::open("a\0b").unwrap_err().code,
            ffi::CARGOBAY_E_ARGUMENT
        );
    }

    #[test]
    fn every_tick_is_seen_once_and_the_end_too() -> Result<(), Error> {
        let create = VirtualCreate::open()?;
        let mut robot = Robot::on(&create)?;
        robot.start()?;
        let mut tick = -1;
        for expected in 0..100 {
            tick = robot.wait(tick, None)?.expect("the loop runs").tick;
            assert_eq!(tick, expected);
        }
        let error = robot.wait(tick, Some(Duration::ZERO)).unwrap_err();
        assert_eq!(error.code, ffi::CARGOBAY_E_TIMEOUT);
        robot.end()?;
        let last = robot.wait(-1, None)?;
        assert!(robot
            .wait(last.map_or(tick, |state| state.tick), None)?
            .is_none());
        Ok(())
    }

    #[test]
    fn a_setpoint_drives_the_robot_and_a_refused_one_does_not() -> Result<(), Error> {
        let create = VirtualCreate::open()?;
        let mut robot = Robot::on(&create)?;
        robot.start()?;
        assert_eq!(
            robot.drive(f64::NAN, 0.0).unwrap_err().code,
            ffi::CARGOBAY_E_ARGUMENT
        );
        let mut tick = -1;
        while let Some(state) = robot.wait(tick, None)? {
            tick = state.tick;
            if tick >= 100 {
                break;
            }
            robot.drive(200.0, 0.0)?;
        }
        let truth = create.truth()?;
        assert!((truth.left_mm_s - 200.0).abs() < 10.0, "{truth:?}");
        Ok(())
    }
}
