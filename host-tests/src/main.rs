//! `alula-sil`: the command line of the host harness.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    loop {}
}

#[cfg(not(target_os = "none"))]
mod commands;

#[cfg(not(target_os = "none"))]
fn main() -> std::process::ExitCode {
    use clap::Parser;
    use clap::error::{ContextKind, ContextValue};
    use std::process::ExitCode;

    let cli = match commands::Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) if error.use_stderr() => {
            // Of what clap adds after an empty line, the names that may have been meant; not the usage.
            let message = error.to_string();
            let lines = || message.lines().map(str::trim);
            let what: Vec<_> = lines().take_while(|line| !line.is_empty()).collect();
            let tip = lines().find_map(|line| line.strip_prefix("tip: "));
            let meant = tip.filter(|tip| tip.contains(" similar "));
            let meant = meant.map_or(String::new(), |tip| format!("; {tip}"));
            let renamed = match error.get(ContextKind::InvalidSubcommand) {
                Some(ContextValue::String(given)) if given == "serve" => "; it is called sitl",
                _ => "",
            };
            eprintln!("{}{meant}{renamed} (see --help)", what.join(" "));
            return ExitCode::from(2);
        }
        // Help and version.
        Err(error) => error.exit(),
    };
    match cli.run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) if is_closed_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!(
                "error: {}",
                alula_sim::named::on_one_line(&format!("{error:#}"))
            );
            ExitCode::FAILURE
        }
    }
}

/// Whether the reader of standard output has seen enough.
#[cfg(not(target_os = "none"))]
fn is_closed_pipe(error: &anyhow::Error) -> bool {
    error.chain().any(|cause| {
        let io = match cause.downcast_ref::<csv::Error>().map(csv::Error::kind) {
            Some(csv::ErrorKind::Io(io)) => Some(io),
            _ => cause.downcast_ref(),
        };
        io.is_some_and(|io: &std::io::Error| io.kind() == std::io::ErrorKind::BrokenPipe)
    })
}
