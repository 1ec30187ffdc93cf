//! `stickslip new`: a scene to begin with.

use anyhow::Result;
use stickslip_formats::{NEW_SCENE, scene_assumptions, scene_schema};

use crate::args::NewArgs;
use crate::failure::hinted;
use crate::files::write_file;
use crate::output::show;
use crate::verdict::Verdict;

/// Runs the command.
pub fn new(args: &NewArgs) -> Result<Verdict> {
    let (scene, schema) = (
        args.folder.join("scene.toml"),
        args.folder.join("scene.schema.json"),
    );
    if scene.exists() {
        return Err(hinted(
            format!("{} is there already", scene.display()),
            "name another folder",
        ));
    }
    write_file(&schema, scene_schema().as_bytes())?;
    write_file(&scene, NEW_SCENE.as_bytes())?;
    let name = scene.display().to_string();
    let assumed = scene_assumptions(NEW_SCENE, &name)?;
    let assumed = assumed.iter().map(|line| format!("\n  {line}"));
    show(format_args!(
        "wrote {name} and, for editors, {}\nPut in your own numbers. As it is:{}",
        schema.display(),
        assumed.collect::<String>()
    ))?;
    Ok(Verdict::Done)
}
