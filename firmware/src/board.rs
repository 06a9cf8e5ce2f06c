//! What the target has: clocks, pins, interrupts, and the loop around [`Flight`].

use core::cell::RefCell;
use core::sync::atomic::{AtomicU32, Ordering};

use alula_firmware::flight::{Flight, TICK_RATE};
use alula_firmware::port::send;
use alula_firmware::thrust::{MotorCurve, Pulse, ThrustOutput};
use alula_firmware::tick::{Watchdog, tick};
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m_rt::{entry, exception};
use critical_section::Mutex;
#[cfg(feature = "rtt")]
use defmt_rtt as _;
#[cfg(all(feature = "semihosting", not(feature = "rtt")))]
use defmt_semihosting as _;
use heapless::Deque;
use stm32f4xx_hal::pac::{self, interrupt};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Config;
use stm32f4xx_hal::serial::Rx;
use stm32f4xx_hal::watchdog::IndependentWatchdog;

#[cfg(not(any(feature = "rtt", feature = "semihosting")))]
compile_error!("choose where the log goes: feature `rtt` (a board) or `semihosting` (QEMU)");

/// Clock of the core. QEMU's machine runs at it whatever the clock tree is told.
const CORE_HZ: u32 = 168_000_000;
/// Speed of the link \[bit/s\]: an input of the guidance takes 0.8 ms, and so does its answer.
const BAUD: u32 = 1_000_000;
/// The log tells how it goes so often.
const LOG_PERIOD: u32 = TICK_RATE;

/// The chip is reset if this passes without a tick of the control loop \[ms\]. The watchdog's own oscillator is slow or
/// fast by half.
const WATCHDOG_MS: u32 = 30;

/// Thrust of the motor: an example, to be replaced by the measurements of yours.
const CURVE: MotorCurve<'static> = match MotorCurve::new(&[
    (0.0, 0.0),
    (20.0, 0.25),
    (60.0, 0.5),
    (120.0, 0.75),
    (200.0, 1.0),
]) {
    Ok(curve) => curve,
    Err(_) => panic!("bad motor curve"),
};

/// Pulses of 1.0, 1.1 and 2.0 ms at 400 Hz.
const PULSE: Pulse = Pulse {
    disarmed: 0.40,
    minimum: 0.44,
    maximum: 0.80,
};

struct Independent(IndependentWatchdog);

impl Watchdog for Independent {
    fn feed(&mut self) {
        self.0.feed();
    }
}

/// Ticks of the timer.
static TICKS: AtomicU32 = AtomicU32::new(0);
/// Bytes received and not yet looked at: several frames.
static RECEIVED: Mutex<RefCell<Deque<u8, 1024>>> = Mutex::new(RefCell::new(Deque::new()));
static RECEIVER: Mutex<RefCell<Option<Rx<pac::USART1>>>> = Mutex::new(RefCell::new(None));

#[exception]
fn SysTick() {
    TICKS.fetch_add(1, Ordering::Relaxed);
}

#[interrupt]
fn USART1() {
    critical_section::with(|cs| {
        if let Some(receiver) = RECEIVER.borrow_ref_mut(cs).as_mut() {
            // A byte lost to line or overrun, here or in the queue, leaves a frame that its checksum refuses.
            if let Ok(byte) = receiver.read() {
                let _ = RECEIVED.borrow_ref_mut(cs).push_back(byte);
            }
        }
    });
}

#[entry]
fn main() -> ! {
    // Both are there: nothing has taken them.
    let (Some(device), Some(core)) = (pac::Peripherals::take(), cortex_m::Peripherals::take())
    else {
        cortex_m::peripheral::SCB::sys_reset();
    };
    // After reset the internal oscillator runs and says so. QEMU's machine has no clock tree to set, and none
    // to wait for.
    let emulated = device.RCC.cr().read().hsirdy().bit_is_clear();
    let mut rcc = device.RCC.freeze(match emulated {
        true => Config::hsi(),
        false => Config::hsi().sysclk(CORE_HZ.Hz()),
    });

    let gpioa = device.GPIOA.split(&mut rcc);
    let gpiob = device.GPIOB.split(&mut rcc);
    let switch = gpiob.pb12.into_pull_up_input();

    let (_, (channel, ..)) = device.TIM3.pwm_hz(400.Hz(), &mut rcc);
    let mut channel = channel.with(gpioa.pa6);
    channel.enable();
    let mut motor = ThrustOutput::new(channel, CURVE, PULSE).unwrap();

    let serial = device
        .USART1
        .serial((gpioa.pa9, gpioa.pa10), BAUD.bps(), &mut rcc);
    let (mut transmitter, mut receiver) = serial.unwrap().split();
    receiver.listen();
    critical_section::with(|cs| RECEIVER.borrow_ref_mut(cs).replace(receiver));
    // SAFETY: no critical section is open.
    unsafe { cortex_m::peripheral::NVIC::unmask(pac::Interrupt::USART1) };

    let mut timer = core.SYST;
    timer.set_clock_source(SystClkSource::Core);
    timer.set_reload(CORE_HZ / TICK_RATE - 1);
    timer.clear_current();
    timer.enable_interrupt();
    timer.enable_counter();

    let mut watchdog = Independent(IndependentWatchdog::new(device.IWDG));
    // A debugger that stops the core stops the watchdog too.
    watchdog.0.stop_on_debug(&device.DBGMCU, true);
    watchdog.0.start(WATCHDOG_MS.millis());

    let mut flight = Flight::default();
    if send(&mut transmitter, &flight.announcement()).is_err() {
        flight.count_dropped();
    }
    defmt::info!("ready, {}", flight.phase());
    let (mut ticks, mut phase, mut reject_reason) = (0, flight.phase(), None);
    loop {
        let reply = if TICKS.load(Ordering::Relaxed) != ticks {
            ticks = ticks.wrapping_add(1);
            let Ok(reply) = tick(&mut flight, &mut motor, switch.is_low(), &mut watchdog);
            if ticks.is_multiple_of(LOG_PERIOD) {
                defmt::info!("{}", flight.status());
            }
            reply
        } else if let Some(byte) =
            critical_section::with(|cs| RECEIVED.borrow_ref_mut(cs).pop_front())
        {
            flight.receive(byte)
        } else {
            // An interrupt that comes between the look and the wait still ends the wait.
            critical_section::with(|cs| {
                if TICKS.load(Ordering::Relaxed) == ticks && RECEIVED.borrow_ref(cs).is_empty() {
                    cortex_m::asm::wfi();
                }
            });
            continue;
        };
        if let Some(reply) = reply
            && send(&mut transmitter, &reply).is_err()
        {
            flight.count_dropped();
        }
        if flight.phase() != phase {
            phase = flight.phase();
            defmt::info!("{}", phase);
        }
        if flight.reject_reason() != reject_reason {
            reject_reason = flight.reject_reason();
            match reject_reason {
                Some(reject_reason) => defmt::error!("input refused: {}", reject_reason),
                None => defmt::info!("input accepted"),
            }
        }
    }
}

defmt::timestamp!("{=u32:ms}", TICKS.load(Ordering::Relaxed));

/// Starts again, with the motor stopped: better than a motor that keeps its last thrust.
#[panic_handler]
fn panic(info: &core::panic::PanicInfo) -> ! {
    defmt::error!("{}", defmt::Display2Format(info));
    cortex_m::peripheral::SCB::sys_reset()
}

#[exception]
unsafe fn HardFault(_: &cortex_m_rt::ExceptionFrame) -> ! {
    cortex_m::peripheral::SCB::sys_reset()
}
