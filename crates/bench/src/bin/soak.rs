//! `soak PROGRAM [SECONDS] [ARGUMENT...]`: rows at 100 Hz through `PROGRAM live` for so long (60
//! s), with dropouts, bursts, repeats, garbage, late rows and pauses. Further arguments are the
//! program's.
//!
//! Prints the time from the sending of a row to the reading of its answer, and the number of lines
//! without an answer. Also prints the program's memory after the first tenth of the time and at the
//! end, its time on processors per row, and the load of the machine before and after. With `--page`
//! among the arguments, Chromium (`STICKSLIP_CHROMIUM`, default `chromium`) has the page open. The
//! rows are those of a demonstration log, sent over and over at 100 Hz where it was recorded at 30
//! Hz. Each time round begins with a pause of the source.

use std::error::Error;
use std::fmt::Write as _;
use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::{self, sleep};
use std::time::{Duration, Instant};

use stickslip::quantile;

const DEMO: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../testkit/experiments/slide-ell-disc-110"
);
const PERIOD: Duration = Duration::from_millis(10);

/// Lines that are sent at one tick.
type Tick = Vec<String>;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let program = arguments
        .next()
        .ok_or("say which program: target/release/stickslip")?;
    let seconds: f64 = arguments.next().map_or(Ok(60.0), |text| text.parse())?;
    let scene = format!("{DEMO}/scene.toml");
    let arguments: Vec<String> = arguments.collect();
    let has_page = arguments
        .iter()
        .any(|argument| argument.starts_with("--page"));
    println!("load before: {}", load());
    let mut child = Command::new(&program)
        .args(["live", &scene])
        .args(&arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()?;
    let told = child.stderr.take().ok_or("no standard error")?;
    let (address, page) = channel();
    let talk = thread::spawn(move || pass_on(BufReader::new(told), &address));
    let mut browser = match has_page {
        true => Some(open_page(&page.recv_timeout(Duration::from_secs(10))?)?),
        false => None,
    };
    let (mut input, output) = (
        child.stdin.take().ok_or("no standard input")?,
        child.stdout.take().ok_or("no standard output")?,
    );
    let (sent, when_sent) = channel();
    let reader = thread::spawn(move || read_answers(BufReader::new(output), &when_sent));

    let ticks = ticks(&fs::read_to_string(format!("{DEMO}/log.csv"))?);
    let begin = Instant::now();
    let memory = send(&ticks, seconds, (&mut input, &sent), child.id())?;
    let busy = processor_seconds(child.id());
    let load_after = load();
    drop((input, sent));
    let status = child.wait()?;
    talk.join()
        .map_err(|_| "the reader of messages broke down")?;
    if let Some(browser) = &mut browser {
        println!(
            "the page was open to the end: {}",
            browser.try_wait()?.is_none()
        );
        browser.kill()?;
        browser.wait()?;
    }
    let answers = reader
        .join()
        .map_err(|_| "the reader of answers broke down")?;
    let early = memory.get(memory.len() / 10).copied().flatten();
    let last = memory.last().copied().flatten();
    print!("{}", summary(&answers, early, last));
    if let Some(busy) = busy {
        let share = 100.0 * busy / begin.elapsed().as_secs_f64();
        let row = 1e3 * busy / answers.len() as f64;
        println!("processors: {busy:.1} s, {share:.0} % of one, {row:.2} ms a row");
    }
    println!("load after: {load_after}");
    println!("exit code {:?}", status.code());
    Ok(())
}

/// Passes on the program's messages, and the address of its page.
fn pass_on(told: impl BufRead, address: &Sender<String>) {
    for line in told.lines().map_while(Result::ok) {
        if let Some(at) = line.find("http://") {
            let _ = address.send(line[at..].trim().to_owned());
        }
        println!("| {line}");
    }
}

/// Sends the rows for so many seconds, and when each was sent; returns the program's memory (MB),
/// second by second.
fn send(
    ticks: &[Tick],
    seconds: f64,
    (input, sent): (&mut impl Write, &Sender<Instant>),
    program: u32,
) -> Result<Vec<Option<f64>>, Box<dyn Error>> {
    let begin = Instant::now();
    let mut memory = Vec::new();
    let mut tick = 0_u64;
    while begin.elapsed().as_secs_f64() < seconds {
        let (round, at) = (tick / ticks.len() as u64, tick as usize % ticks.len());
        for line in &ticks[at] {
            // each round is 100 s later by the source's clock; JSON has no numbers that begin with 00
            let line = line.replace("ROUND", &(round + 1).to_string());
            sent.send(Instant::now())?;
            writeln!(input, "{line}")?;
        }
        if tick.is_multiple_of(100) {
            memory.push(resident_megabytes(program));
        }
        tick += 1;
        let next = PERIOD * tick as u32;
        sleep(next.saturating_sub(begin.elapsed()));
    }
    Ok(memory)
}

/// The log's rows, tick by tick, as a bad day at the laboratory has them.
fn ticks(log: &str) -> Vec<Tick> {
    let mut lines = log.lines();
    let names: Vec<&str> = lines.next().unwrap_or_default().split(',').collect();
    let row = |index: usize, cells: &str| {
        let cells = names.iter().zip(cells.split(',')).skip(1);
        let mut text = format!("{{\"time\": ROUND{:02}.{:02}", index / 100, index % 100);
        for (name, cell) in cells.filter(|(_, cell)| !cell.is_empty()) {
            let _ = write!(text, ", \"{name}\": {cell}");
        }
        text + "}"
    };
    let rows: Vec<String> = lines
        .enumerate()
        .map(|(index, cells)| row(index, cells))
        .collect();
    let mut ticks: Vec<Tick> = Vec::new();
    let mut held = Vec::new();
    for (index, row) in rows.iter().enumerate() {
        held.push(row.clone());
        match index % 100 {
            // a dropout of three rows, and a burst of ten
            20..=22 => held.clear(),
            40..=48 => ticks.push(Vec::new()),
            // a repeat, garbage, and a late row
            60 => ticks.push(vec![row.clone(), row.clone()]),
            70 => ticks.push(vec![
                row.clone(),
                "GET / HTTP/1.1".to_owned(),
                "\u{1}[[[".to_owned(),
            ]),
            80 => ticks.push(vec![row.clone(), rows[index - 3].clone()]),
            _ => ticks.push(held.clone()),
        }
        if !matches!(index % 100, 40..=48) {
            held.clear();
        }
    }
    ticks
}

/// An answer: how long it took (s), and whether it was an estimate.
struct Answer {
    seconds: f64,
    estimate: bool,
}

fn read_answers(output: impl BufRead, sent: &Receiver<Instant>) -> Vec<Answer> {
    let lines = output.lines().map_while(Result::ok);
    lines
        .zip(sent.iter())
        .map(|(line, sent)| Answer {
            seconds: sent.elapsed().as_secs_f64(),
            estimate: !line.contains("\"error\""),
        })
        .collect()
}

/// A browser that has the page open.
fn open_page(address: &str) -> Result<Child, Box<dyn Error>> {
    let chromium = std::env::var("STICKSLIP_CHROMIUM").unwrap_or("chromium".to_owned());
    let profile = std::env::temp_dir().join(format!("stickslip-soak-{}", std::process::id()));
    let mut command = Command::new(chromium);
    command.args([
        "--headless",
        "--no-sandbox",
        "--disable-gpu",
        "--remote-debugging-port=0",
    ]);
    command
        .arg(format!("--user-data-dir={}", profile.display()))
        .arg(address);
    let browser = command
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()?;
    sleep(Duration::from_secs(3));
    Ok(browser)
}

/// Mean number of processes that ran or waited in the last 1, 5 and 15 minutes, where Linux reports
/// it.
fn load() -> String {
    let told = fs::read_to_string("/proc/loadavg").unwrap_or_default();
    told.split(' ').take(3).collect::<Vec<_>>().join(" ")
}

/// Time that all threads of a process were on a processor (s), where Linux reports it.
fn processor_seconds(process: u32) -> Option<f64> {
    /// Unit of the system's times (1/s).
    const TICKS: f64 = 100.0;
    let stat =
        fs::read_to_string(Path::new("/proc").join(process.to_string()).join("stat")).ok()?;
    // behind the name in brackets: state, ten more, then the times in user and system mode
    let numbers: Vec<&str> = stat.rsplit_once(')')?.1.split_whitespace().collect();
    let [user, system] = [numbers.get(11)?, numbers.get(12)?];
    Some((user.parse::<f64>().ok()? + system.parse::<f64>().ok()?) / TICKS)
}

/// Memory of a process that is in use (MB), where Linux reports it.
fn resident_megabytes(process: u32) -> Option<f64> {
    let status = fs::read_to_string(Path::new("/proc").join(process.to_string()).join("status"));
    let status = status.ok()?;
    let line = status.lines().find(|line| line.starts_with("VmRSS:"))?;
    let kilobytes: f64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kilobytes / 1000.0)
}

fn summary(answers: &[Answer], early: Option<f64>, last: Option<f64>) -> String {
    let mut text = String::new();
    let estimates = answers.iter().filter(|answer| answer.estimate);
    let times: Vec<f64> = estimates.map(|answer| 1e3 * answer.seconds).collect();
    let at = |q| quantile(&times, q).unwrap_or(f64::NAN);
    let _ = writeln!(
        text,
        "{} answers, {} of them estimates: {:.2} ms (median), {:.2} ms (99 %), {:.2} ms (all)",
        answers.len(),
        times.len(),
        at(0.5),
        at(0.99),
        at(1.0)
    );
    if let (Some(early), Some(last)) = (early, last) {
        let _ = writeln!(
            text,
            "memory: {early:.1} MB after a tenth, {last:.1} MB at the end"
        );
    }
    text
}
