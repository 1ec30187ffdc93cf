//! `stickslip live --page` or `stickslip view` as a test runs it: [`Session`].

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, ChildStderr, ChildStdin, Command, Stdio};

use serde_json::Value;

use super::{Experiment, stickslip};

/// A session with a page.
pub struct Session {
    child: Child,
    /// Source of its rows.
    pub input: Option<ChildStdin>,
    errors: BufReader<ChildStderr>,
    /// 127.0.0.1:port.
    pub host: String,
    /// End of the page's address.
    pub token: String,
}

impl Session {
    /// Starts one over the scene of an experiment.
    pub fn start(case: &Experiment) -> Self {
        let mut command = stickslip();
        command.args(["live", &case.scene(), "--particles", "64", "--page"]);
        Self::of(command)
    }

    /// Starts `stickslip view`.
    pub fn view(folders: &[&str]) -> Self {
        let mut command = stickslip();
        command.arg("view").args(folders);
        Self::of(command)
    }

    fn of(mut command: Command) -> Self {
        let pipes = command
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(Stdio::piped());
        let mut child = pipes.spawn().unwrap();
        let input = child.stdin.take();
        let mut errors = BufReader::new(child.stderr.take().unwrap());
        let mut told = String::new();
        errors.read_line(&mut told).unwrap();
        let address = told
            .trim()
            .strip_prefix("open http://")
            .unwrap_or_else(|| panic!("{told}"));
        let (host, token) = address.split_once("/?").unwrap();
        assert!(
            host.starts_with("127.0.0.1:") && token.len() == 32,
            "{told}"
        );
        let (host, token) = (host.to_owned(), token.to_owned());
        Self {
            child,
            input,
            errors,
            host,
            token,
        }
    }

    /// Answer of the server to a request; `TOKEN` and `HOST` stand for its own.
    pub fn ask(&self, request: &str) -> String {
        let request = request
            .replace("TOKEN", &self.token)
            .replace("HOST", &self.host);
        let mut stream = TcpStream::connect(&self.host).unwrap();
        stream
            .write_all(request.replace('\n', "\r\n").as_bytes())
            .unwrap();
        let mut answer = Vec::new();
        let _ = stream.read_to_end(&mut answer);
        String::from_utf8_lossy(&answer).into_owned()
    }

    /// Answer to a question of the page, or its refusal.
    pub fn post(&self, what: &str, question: &Value) -> Result<String, String> {
        let body = question.to_string();
        let length = body.len();
        let answer = self.ask(&format!(
            "POST /{what}?TOKEN HTTP/1.1\nHost: HOST\nOrigin: http://HOST\nContent-Length: {length}\n\n{body}"
        ));
        let (_, text) = answer.split_once("\r\n\r\n").unwrap();
        let mut said: Value = serde_json::from_str(text).unwrap();
        let [answer, error] = ["answer", "error"].map(|key| said[key].take());
        let text = |of: Value| of.as_str().map(str::to_owned);
        text(answer).ok_or_else(|| text(error).unwrap())
    }

    /// Ends the source: exit code.
    pub fn end(mut self) -> Option<i32> {
        drop(self.input.take());
        let mut told = String::new();
        self.errors.read_to_string(&mut told).unwrap();
        self.child.wait().unwrap().code()
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
