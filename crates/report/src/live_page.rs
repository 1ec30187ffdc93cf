//! The page that shows a tracker at work: [`live_page`].

use maud::{DOCTYPE, PreEscaped, html};
use serde_json::json;
use stickslip::dynamics::Scene;
use stickslip_evaluation::Variant;

use crate::colour::Colour;
use crate::outline::{Outline, bounds};
use crate::page::{SCRIPT, head};
use crate::playback_data::body;

const LIVE: &str = include_str!("../page/live.js");

/// The page for a scene, as HTML text. It loads nothing; it opens a WebSocket at `/socket`, with
/// the page's own query, and draws the newest message.
#[must_use]
pub fn live_page(scene: &Scene, title: &str) -> String {
    let outline = |shape| Outline::new(shape);
    let fixels = scene.fixels.iter();
    let fixels: Vec<Outline> = fixels
        .map(|fixel| outline(&fixel.shape).at(&fixel.pose))
        .collect();
    let corners = fixels.iter().filter_map(Outline::bounds).flatten();
    let [low, high] = bounds(corners).unwrap_or([[-0.02; 2], [0.02; 2]]);
    let view = [low[0], low[1], high[0], high[1]].map(|x| 1e3 * x);
    let data = json!({
        "object": body(&outline(&scene.object.shape)),
        "fingers": scene.pusher.fingers.iter().map(|finger| body(&outline(finger))).collect::<Vec<_>>(),
        "fixels": fixels.iter().map(body).collect::<Vec<_>>(),
        "reach": 1e3 * scene.object.shape.bounding_radius(),
        "view": view,
        "colour": Colour::of(Variant::Particle).hex(),
    });
    let data = data.to_string().replace('<', "\\u003c");
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            (head(title))
            body {
                main {
                    h1 { (title) }
                    section class="player live" {
                        div class="stage" {
                            svg role="img" aria-label="The object, the pusher and the fixels seen from above" {}
                            div class="badge" { "no connection" }
                            div class="clock" {}
                        }
                        div class="side" {
                            table class="readout" {
                                thead { tr { th scope="col" { "estimate" } th scope="col" {} th scope="col" {} } }
                                tbody {}
                            }
                            svg class="history strip" viewBox="0 0 100 30" preserveAspectRatio="none" role="img" aria-label="Spread in the last minute; shaded while the camera is off" {
                                path class="dark" {}
                                g class="curve" style={ "--colour:" (Colour::of(Variant::Particle).hex()) } { path class="line" {} }
                            }
                            p class="most" {}
                            p class="legend" {
                                "Filled: what the camera measures. Coloured: the estimate; thin: particles. Fixels are yellow while their sensor "
                                "is touched; rims turn yellow with the estimated probability that they press on the object: at rest they may touch without."
                            }
                        }
                        script type="application/json" { (PreEscaped(data)) }
                    }
                }
                script { (PreEscaped(SCRIPT)) }
                script { (PreEscaped(LIVE)) }
            }
        }
    };
    page.into_string()
}
