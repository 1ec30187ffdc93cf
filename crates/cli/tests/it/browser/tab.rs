//! A page in Chromium that goes on while a test asks it: [`Tab`], over the browser's own protocol.

use std::io::{BufRead, BufReader};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};

use serde_json::{Value, json};
use tungstenite::stream::MaybeTlsStream;
use tungstenite::{Message, WebSocket, connect};

/// A browser with one page, ended when it is dropped.
pub struct Tab {
    browser: Child,
    socket: WebSocket<MaybeTlsStream<TcpStream>>,
    /// Name of the page in the protocol.
    page: Option<String>,
    asked: u64,
    /// Messages of the page to its console, and its errors.
    pub console: Vec<Value>,
}

impl Tab {
    /// Opens the page at `address` in a window of some width (px); the browser's profile lies in
    /// `folder`.
    pub fn open(folder: &Path, address: &str, width: u32) -> Self {
        let program = std::env::var("STICKSLIP_CHROMIUM").unwrap_or_else(|_| "chromium".to_owned());
        let mut browser = Command::new(&program)
            .args([
                "--headless",
                "--no-sandbox",
                "--disable-gpu",
                "--remote-debugging-port=0",
            ])
            .arg(format!("--user-data-dir={}", folder.display()))
            .arg("about:blank")
            .stderr(Stdio::piped())
            .spawn()
            .unwrap_or_else(|error| {
                panic!(
                    "{program} cannot be run: {error}; install it, or name it in STICKSLIP_CHROMIUM"
                )
            });
        let mut told = BufReader::new(browser.stderr.take().unwrap()).lines();
        let door = told
            .by_ref()
            .map_while(Result::ok)
            .find_map(|line| Some(line.strip_prefix("DevTools listening on ")?.to_owned()))
            .expect("Chromium says where it can be asked");
        // output that is not read would block the browser
        std::thread::spawn(move || told.for_each(drop));
        let (socket, _) = connect(door).unwrap();
        let mut tab = Self {
            browser,
            socket,
            page: None,
            asked: 0,
            console: Vec::new(),
        };
        let target = tab.ask("Target.createTarget", json!({"url": "about:blank"}));
        let target = json!({"targetId": target["targetId"], "flatten": true});
        let page = tab.ask("Target.attachToTarget", target);
        tab.page = page["sessionId"].as_str().map(str::to_owned);
        let window =
            json!({"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": false});
        tab.ask("Emulation.setDeviceMetricsOverride", window);
        for domain in ["Runtime.enable", "Log.enable"] {
            tab.ask(domain, json!({}));
        }
        tab.ask("Page.navigate", json!({"url": address}));
        tab
    }

    /// Value of an expression, or of its promise, in the page.
    pub fn evaluate(&mut self, expression: &str) -> Value {
        let what = json!({"expression": expression, "awaitPromise": true, "returnByValue": true});
        let mut told = self.ask("Runtime.evaluate", what);
        assert!(
            told.get("exceptionDetails").is_none(),
            "{expression}: {told:#}"
        );
        told["result"]["value"].take()
    }

    /// Chooses files in the page's file input.
    pub fn choose_files(&mut self, files: &[&str]) {
        let root = self.ask("DOM.getDocument", json!({}))["root"]["nodeId"].take();
        let input = json!({"nodeId": root, "selector": "input[type=file]"});
        let input = self.ask("DOM.querySelector", input)["nodeId"].take();
        self.ask(
            "DOM.setFileInputFiles",
            json!({"nodeId": input, "files": files}),
        );
    }

    fn ask(&mut self, method: &str, parameters: Value) -> Value {
        self.asked += 1;
        let mut question = json!({"id": self.asked, "method": method, "params": parameters});
        if let Some(page) = &self.page {
            question["sessionId"] = page.as_str().into();
        }
        self.socket
            .send(Message::text(question.to_string()))
            .unwrap();
        loop {
            let Message::Text(text) = self.socket.read().unwrap() else {
                continue;
            };
            let mut answer: Value = serde_json::from_str(&text).unwrap();
            if answer["id"] == self.asked {
                assert!(answer.get("error").is_none(), "{method}: {answer:#}");
                return answer["result"].take();
            }
            let told = [
                "Runtime.consoleAPICalled",
                "Runtime.exceptionThrown",
                "Log.entryAdded",
            ];
            if told.iter().any(|told| answer["method"] == *told) {
                self.console.push(answer);
            }
        }
    }
}

impl Drop for Tab {
    fn drop(&mut self) {
        let _ = self.browser.kill();
        let _ = self.browser.wait();
    }
}
