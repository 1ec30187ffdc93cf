//! The page on which logs are checked, run and changed: [`view_page`].

use maud::{DOCTYPE, PreEscaped, html};
use serde_json::json;

use crate::page::{FIGURES, SCRIPT, head};

const VIEW: &str = include_str!("../page/view.js");

/// The page for logs of these names, as HTML text; together, files that are dropped on it have at
/// most `most_mb` (MB). It asks the server that it comes from, with the page's own query.
#[must_use]
pub fn view_page(logs: &[String], most_mb: u64) -> String {
    let data = json!({ "logs": logs, "mostMegabytes": most_mb });
    let data = data.to_string().replace('<', "\\u003c");
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            (head("stickslip view"))
            body {
                main class="view" {
                    h1 { "stickslip view" }
                    p { "Choose a log, look at its scene, run the filter, and change what you are not sure of." }
                    fieldset {
                        legend { "1. Log" }
                        ul class="logs" aria-label="logs" {}
                        p class="drop" {
                            label { "Drop a scene (.toml) and its log (.csv) on this page, or choose both: " input type="file" multiple accept=".toml,.csv"; }
                        }
                    }
                    p class="failed" role="alert" {}
                    div class="log" hidden {
                        fieldset {
                            legend { "2. Check of scene and log" }
                            ul class="findings" aria-live="polite" {}
                            details { summary { "what is as it should be" } ul class="findings fine" {} }
                        }
                        fieldset class="filter" {
                            legend { "3. Filter: a change runs it again" }
                            div class="sliders" {}
                            div class="controls" {
                                button type="button" class="play run" { "Run the filter" }
                                progress max="1" value="0" aria-label="progress of the filter" {}
                                span class="said" role="status" {}
                                button type="button" class="keep" { "Save as scene.toml" }
                            }
                        }
                        div class="shown" {}
                    }
                    script type="application/json" { (PreEscaped(data)) }
                }
                script { (PreEscaped(SCRIPT)) (PreEscaped(FIGURES)) (PreEscaped(VIEW)) }
            }
        }
    };
    page.into_string()
}
