//! Prototype.
use alula::guidance::Phase;
use alula_sim::experiment::{Document, Experiment};
use alula_sim::simulate::simulate;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

#[derive(Default, Clone, Debug)]
struct Out {
    cross: u32,
    cross_s: f64,
    stall: u32,
    alt2: f64,
    alt_max: f64,
    thrust: f64,
    n: u32,
    lost: bool,
    err2: f64,
}

fn experiment(seed: u64, w20: f64, told: &str, extra: &[String]) -> Experiment {
    let mut r = ChaCha8Rng::seed_from_u64(seed);
    let mut u = |a: f64, b: f64| {
        let x: f64 = r.random();
        a + x * (b - a)
    };
    let mut d = Document::load("circle-40").unwrap();
    let mut a = |t: String| d.assign(&t).unwrap_or_else(|e| panic!("{t}: {e}"));
    a(format!("seed={}", seed));
    a("duration_s=60.0".into());
    a("entry_s=10.0".into());
    a("bounds={}".into());
    a("path_in_air=true".into());
    let (speed, radius) = (u(20.0, 24.0), u(60.0, 120.0));
    let (m, k) = (u(0.93, 1.07), u(0.85, 1.15));
    a(format!("controller.guidance.vehicle.mass_kg={}", 10.0 * m));
    a(format!(
        "controller.guidance.vehicle.k_a_kg_m={}",
        0.646 * k
    ));
    let c0 = u(0.03, 0.06);
    a("controller.guidance.vehicle.c_y=0.5".into());
    a(format!("vehicle.aerodynamics.combined.c0={c0}"));
    a("controller.guidance.vehicle.aerodynamics.combined={c0=0.03,c1=0.9430,c2=5.4934,c3=0.3000,alpha_bar_deg=11.0,k_l=28.0,k_d=167.0}".into());
    a(format!(
        "controller.guidance.vehicle.aerodynamics.combined.c0={c0}"
    ));
    a(format!(
        "weather.turbulence={{wind_at_20_ft_m_s={w20:?},height_m=50.0}}"
    ));
    for (n, s) in [
        ("velocity_m_s", 0.05),
        ("position_m", 0.1),
        ("attitude_deg", 0.2),
        ("air_m_s", 0.3),
        ("acceleration_m_s2", 0.3),
    ] {
        a(format!("sensors.{n}={{noise={s}}}"));
    }
    if seed % 2 == 0 {
        a(format!(
            "path={{circle={{radius_m={radius},speed_m_s={speed}}}}}"
        ));
    } else {
        let mut legs =
            format!("{{lasts_s=8.0,speed_m_s={speed:?},from_m_s={speed:?},course_deg=0.0}}");
        let mut t = 8.0;
        while t < 60.0 {
            let s = if u(0.0, 1.0) > 0.5 { 1.0 } else { -1.0 };
            let (arc, line) = (u(3.0, 10.0), u(4.0, 10.0));
            legs += &format!(
                ",{{lasts_s={arc:?},radius_m={:?}}},{{lasts_s={line:?}}}",
                s * u(60.0, 120.0)
            );
            t += arc + line;
        }
        a(format!("path={{legs=[{legs}]}}"));
    }
    match told {
        "vector" => {}
        "vector-no" => a("sensors.accelerometer=\"none\"".into()),
        "wind" => a("sensors.air=\"wind-estimate\"".into()),
        "wind-no" => {
            a("sensors.air=\"wind-estimate\"".into());
            a("sensors.accelerometer=\"none\"".into())
        }
        "pitot" => a("sensors.air=\"pitot\"".into()),
        "pitot-no" => {
            a("sensors.air=\"pitot\"".into());
            a("sensors.accelerometer=\"none\"".into())
        }
        "nothing" => a("sensors.air=\"none\"".into()),
        _ => panic!(),
    }
    for e in extra {
        a(e.clone());
    }
    d.experiment().unwrap()
}

fn fly(e: &Experiment) -> Out {
    let mut o = Out::default();
    let (mut was, mut since, mut stalled) = (false, 0.0, false);
    let _ = simulate(e, e.controller().unwrap().as_mut(), |s| {
        if s.t < e.entry_s {
            return true;
        }
        let c = s
            .answer
            .guided()
            .is_some_and(|g| g.progress.phase == Phase::Crossing);
        if c && !was {
            o.cross += 1;
        }
        was = c;
        if c {
            o.cross_s += 0.01;
        }
        let alpha = s.wing_alpha(e).abs();
        if alpha > 15f64.to_radians() {
            since += 0.01
        } else {
            since = 0.0;
            stalled = false;
        }
        if since > 0.3 && !stalled {
            stalled = true;
            o.stall += 1;
        }
        o.alt2 += s.position_error().z.powi(2);
        o.alt_max = o.alt_max.max(s.position_error().z.abs());
        o.thrust += s.truth.thrust / e.weight();
        o.err2 += s.velocity_error().norm_squared();
        o.n += 1;
        if s.position_error().z > 50.0 {
            o.lost = true;
        }
        true
    });
    o
}

fn trace(e: &Experiment) {
    let mut rows: Vec<String> = vec![];
    let mut until = -1.0;
    let mut was = false;
    let _ = simulate(e, e.controller().unwrap().as_mut(), |s| {
        let g = s.answer.guided().unwrap();
        let c = g.progress.phase == Phase::Crossing;
        let va = s.truth.velocity - s.wind;
        let fwd = s.target.velocity.normalize();
        let ve = s.velocity_error();
        let [i, j, _] = s.truth.axes();
        let ahat = g.command.diagnostics.v_a;
        let o = |n: usize| {
            let _ = n;
            0f32
        };
        let row = format!(
            "{:5.2} law={:4.2} th_v-th={:5.1} rate_v={:5.2} q={:5.2} qc={:5.2} c={} va={:5.2} va_est={:5.2} alpha={:5.1} alpha_est={:5.1} err fwd={:5.2} down={:5.2} pos fwd={:5.2} down={:5.2} wind=({:5.2},{:5.2},{:5.2}) T={:5.1} Tc={:5.1} fp_ref=({:5.2} {:5.2}) pitch={:5.1}",
            s.t,
            o(13),
            o(15).to_degrees(),
            o(14),
            s.truth.rates.y,
            g.command.rates.pitch,
            c as u8,
            va.norm(),
            ahat.norm_squared().sqrt(),
            (va.dot(&j)).atan2(-va.dot(&i)).to_degrees(),
            ahat.j.atan2(-ahat.i).to_degrees(),
            ve.dot(&fwd),
            ve.z,
            s.position_error().dot(&fwd),
            s.position_error().z,
            s.wind.x,
            s.wind.y,
            s.wind.z,
            s.truth.thrust,
            g.command.thrust,
            (g.reference.velocity.north - s.target.velocity.x as f32),
            (g.reference.velocity.down - s.target.velocity.z as f32),
            s.pitch().to_degrees()
        );
        rows.push(row);
        if s.t > 10.0 && c && !was && until < s.t {
            until = s.t + 0.7;
            let n = rows.len();
            println!("----");
            for r in rows[n.saturating_sub(120)..].iter().step_by(10) {
                println!("{r}");
            }
        } else if s.t < until && rows.len() % 10 == 0 {
            println!("{}", rows.last().unwrap());
        }
        was = c;
        true
    });
}

fn main() {
    if std::env::args().nth(1).as_deref() == Some("trace") {
        let a: Vec<String> = std::env::args().collect();
        trace(&experiment(
            a[2].parse().unwrap(),
            a[4].parse().unwrap(),
            &a[3],
            &a[5..],
        ));
        return;
    }
    let args: Vec<String> = std::env::args().skip(1).collect();
    let args: Vec<String> = args.into_iter().collect();
    let first: u64 = args[0].parse().unwrap();
    let n: u64 = args[1].parse().unwrap();
    let kinds: Vec<&str> = args[2].split(',').collect();
    let winds: Vec<f64> = args[3].split(',').map(|w| w.parse().unwrap()).collect();
    let extra = &args[4..];
    println!(
        "| told | W20 | flights crossing | per min | flights α>15° 0.3 s | per min | alt rms m | alt max (95 %) | vel rms | thrust/W | lost |"
    );
    for w in winds {
        for k in &kinds {
            let next = AtomicU64::new(0);
            let all = Mutex::new(Vec::new());
            std::thread::scope(|s| {
                for _ in 0..2 {
                    s.spawn(|| {
                        loop {
                            let i = next.fetch_add(1, Ordering::Relaxed);
                            if i >= n {
                                break;
                            }
                            let o = fly(&experiment(first + i, w, k, extra));
                            all.lock().unwrap().push((i, o));
                        }
                    });
                }
            });
            let mut all = all.into_inner().unwrap();
            all.sort_by_key(|x| x.0);
            let o: Vec<Out> = all.into_iter().map(|x| x.1).collect();
            let m = o.iter().map(|o| o.n as f64 / 6000.0).sum::<f64>();
            let steps = o.iter().map(|o| o.n as f64).sum::<f64>();
            let pc = |f: &dyn Fn(&Out) -> bool| {
                100.0 * o.iter().filter(|o| f(o)).count() as f64 / n as f64
            };
            let mut am: Vec<f64> = o.iter().map(|o| o.alt_max).collect();
            am.sort_by(f64::total_cmp);
            println!(
                "| {k} | {w} | {:.1} % | {:.2} | {:.1} % | {:.2} | {:.2} | {:.2} | {:.2} | {:.3} | {:.1} % |",
                pc(&|o| o.cross > 0),
                o.iter().map(|o| o.cross as f64).sum::<f64>() / m,
                pc(&|o| o.stall > 0),
                o.iter().map(|o| o.stall as f64).sum::<f64>() / m,
                (o.iter().map(|o| o.alt2).sum::<f64>() / steps).sqrt(),
                am[(am.len() as f64 * 0.95) as usize],
                (o.iter().map(|o| o.err2).sum::<f64>() / steps).sqrt(),
                o.iter().map(|o| o.thrust).sum::<f64>() / steps,
                pc(&|o| o.lost)
            );
        }
    }
}
