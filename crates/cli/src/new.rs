//! `stickslip new`: a scene to begin with.

use std::path::Path;

use anyhow::Result;
use stickslip_formats::{
    NEW_SCENE, Outline, OutlineOptions, read_dxf_outline, read_svg_outline, scene_assumptions,
    scene_schema,
};

use crate::args::NewArgs;
use crate::experiment::text_of;
use crate::failure::hinted;
use crate::files::write_file;
use crate::output::{counted, show, talk};
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
    let outline = args.outline.as_deref().map(|path| outline(args, path));
    let outline = outline.transpose()?;
    let text = outline
        .as_ref()
        .map_or(NEW_SCENE.to_owned(), Outline::scene);
    write_file(&schema, scene_schema().as_bytes())?;
    write_file(&scene, text.as_bytes())?;
    let name = scene.display().to_string();
    if let Some(outline) = &outline {
        show(format_args!("{}", described(outline, args.tolerance)))?;
        if outline.holes > 0 {
            talk(format_args!(
                "warning: {} left out of the outline; give inertia and tripod_radius, which differ from those of a full plate",
                counted(outline.holes as u64, "hole")
            ));
        }
    }
    // a plate with holes has no middle of its own that could be assumed
    let full = outline.as_ref().is_none_or(|outline| outline.holes == 0);
    let assumed = if full {
        scene_assumptions(&text, &name)?
    } else {
        Vec::new()
    };
    let assumed = assumed.iter().map(|line| format!("\n  {line}"));
    show(format_args!(
        "wrote {name} and, for editors, {}\nFill in your own numbers. Assumed for missing keys:{}",
        schema.display(),
        assumed.collect::<String>()
    ))?;
    Ok(Verdict::Done)
}

/// The outline of a drawing, by the ending of its name.
fn outline(args: &NewArgs, path: &Path) -> Result<Outline> {
    let options = OutlineOptions {
        scale: args.scale,
        tolerance: args.tolerance,
    };
    let name = path.display().to_string();
    let ending = path.extension().and_then(|ending| ending.to_str());
    match ending.unwrap_or("").to_ascii_lowercase().as_str() {
        "svg" => Ok(read_svg_outline(
            &text_of(path, "drawing")?,
            &name,
            &options,
        )?),
        "dxf" => Ok(read_dxf_outline(
            &text_of(path, "drawing")?,
            &name,
            &options,
        )?),
        _ => Err(hinted(
            format!("{name}: only drawings whose names end in .svg or .dxf can be read"),
            "save the drawing as one of them",
        )),
    }
}

/// Description of the outline of a drawing.
fn described(outline: &Outline, tolerance: f64) -> String {
    let Outline {
        parts,
        vertices,
        size: [width, height],
        area,
        centre: [x, y],
        unit,
        ..
    } = outline;
    format!(
        "outline: {:.3} x {:.3} mm, {:.1} mm^2, {vertices} vertices in {}, within {} mm of the drawing's curves; the drawing is in {unit}\n\
         its centroid, at ({:.3}, {:.3}) mm in the drawing with y up, is the origin: the assumed centre of mass",
        1e3 * width,
        1e3 * height,
        1e6 * area,
        counted(parts.len() as u64, "convex part"),
        1e3 * tolerance,
        1e3 * x,
        1e3 * y
    )
}
