//! The experiment as a page: the thesis's tables with our measurements.

use std::fmt::Write as _;

use super::paper::{self, MODELS};
use super::study::{Experiment, MeshResult, PlanePoint, TechniqueFigures};
use super::write::{FEATURED, error_file, time_file};
use crate::lab::study::words::{mib, ms, percent, significant};

/// The page; `folder` is the folder of the plots relative to the page, with `/` at its end, or empty.
pub fn to_markdown(experiment: &Experiment, folder: &str) -> String {
    let mut text = String::new();
    head(&mut text, experiment);
    let featured: Vec<&MeshResult> = FEATURED
        .iter()
        .filter_map(|name| experiment.meshes.iter().find(|mesh| mesh.name == *name))
        .collect();
    for mesh in &featured {
        shape(&mut text, mesh, folder);
    }
    summary(&mut text, experiment);
    memory(&mut text, experiment);
    text
}

fn head(text: &mut String, e: &Experiment) {
    let _ = write!(
        text,
        "# Level maps: planes, slices and hits\n\n\
        This page repeats the experiments of W. Tipprasert's thesis (2006, ch. 5). Light is placed on a mesh by slice images \
        (method `volumetric`), by reference planes on a level map (method `planes`, slicing `uniform` and `smart`), and at the \
        points where rays hit (method `level_map`, the default).\n\n\
        On {} ({}), {} cores; {}² water cells, {}² texels, median of {} interleaved runs; times are GPU times of whole frames \
        with level maps cached. Errors are relative L1 of the map on the mesh against the float64 reference.\n\n\
        The thesis used a GeForce 6800 and tested all beams on every plane. Our three techniques all cull beams against the \
        mesh's map, deposit by exact coverage, and need no test per pixel of a rasteriser. Ratios can be compared, milliseconds \
        cannot. In the \
        thesis's table 5-1 the volumetric times of teapot and sphere are equal to the last digit in every row, so one of the \
        two columns is a copy.\n",
        e.adapter.name, e.adapter.driver, e.cores, e.water_cells, e.texels, e.runs
    );
}

fn ratio(a: f64, b: f64) -> String {
    if b > 0.0 {
        significant(a / b, 3)
    } else {
        String::new()
    }
}

fn shape(text: &mut String, mesh: &MeshResult, folder: &str) {
    let polygons = MODELS
        .iter()
        .find(|model| model.name == mesh.name)
        .map(|m| m.polygons);
    let _ = write!(text, "\n## {}\n\n{} triangles", mesh.name, mesh.triangles);
    if let Some(polygons) = polygons {
        let _ = write!(text, " (table 5-2: {polygons} polygons)");
    }
    if let Some(error) = mesh.truth_error {
        let _ = write!(text, "; the reference's own error is {}", percent(error));
    }
    let _ = write!(
        text,
        ".\n\n![Time against planes]({folder}{})\n",
        time_file(&mesh.name, "svg")
    );
    if mesh.truth_error.is_some() {
        let _ = write!(
            text,
            "\n![Error against time]({folder}{})\n",
            error_file(&mesh.name, "svg")
        );
    }
    let _ = write!(
        text,
        "\nTime (tables 5-1 and 5-3) and planes in use (table 5-4); the thesis's figures in brackets.\n\n\
        | planes | volumetric ms | uniform ms | smart ms | volumetric ÷ uniform | smart ÷ uniform | used | pieces |\n\
        |---:|---:|---:|---:|---:|---:|---:|---:|\n"
    );
    for p in &mesh.planes {
        let row = paper::row_of(&mesh.name, p.planes);
        let beside = |value: Option<String>| value.map_or(String::new(), |v| format!(" ({v})"));
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {}{} | {}{} | {}{} | {} |",
            p.planes,
            ms(p.volumetric.ms.median),
            ms(p.uniform.ms.median),
            ms(p.smart.ms.median),
            ratio(p.volumetric.ms.median, p.uniform.ms.median),
            beside(row.map(|r| ratio(r.volumetric, r.level_map))),
            ratio(p.smart.ms.median, p.uniform.ms.median),
            beside(row.map(|r| ratio(r.smart, r.level_map))),
            p.used,
            beside(row.map(|r| r.used.to_string())),
            p.sub_boxes,
        );
    }
    quality(text, mesh);
}

fn quality(text: &mut String, mesh: &MeshResult) {
    let error = |value: Option<f64>| value.map_or_else(String::new, percent);
    text.push_str(
        "\nDifference of the pictures (table 5-5, mean distance in CIE Luv; the thesis has 0 everywhere), memory, and error.\n\n\
        | planes | Luv smart | Luv volumetric | texels apart | volumetric MiB | by the allocator | level map MiB | by the allocator | error \
        volumetric | error planes |\n|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n",
    );
    for p in &mesh.planes {
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} of {} | {} | {} | {} | {} | {} | {} |",
            p.planes,
            luv(p.luv_smart),
            luv(p.luv_volumetric),
            p.texels_apart,
            p.texels,
            mib(p.volumetric.peak_bytes),
            p.volumetric.allocated_bytes.map_or_else(String::new, mib),
            mib(p.uniform.peak_bytes),
            p.uniform.allocated_bytes.map_or_else(String::new, mib),
            error(p.volumetric.error),
            error(p.uniform.error),
        );
    }
    text.push_str("\nPlacement by hits:\n\n| water cells | split levels | ms | error |\n|---:|---:|---:|---:|\n");
    for hit in &mesh.hits {
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} |",
            hit.water_cells,
            hit.split_levels,
            ms(hit.figures.ms.median),
            error(hit.figures.error)
        );
    }
}

fn luv(value: f64) -> String {
    if value == 0.0 {
        "0".to_owned()
    } else {
        significant(value, 2)
    }
}

/// The point nearest to a number of planes.
fn near(mesh: &MeshResult, planes: u32) -> Option<&PlanePoint> {
    mesh.planes.iter().min_by_key(|p| p.planes.abs_diff(planes))
}

fn summary(text: &mut String, e: &Experiment) {
    let most = e
        .meshes
        .iter()
        .flat_map(|m| &m.planes)
        .map(|p| p.planes)
        .max()
        .unwrap_or_default();
    let _ = write!(
        text,
        "\n## All shapes\n\nAt about 50 and at {most} planes. Errors are those at {most} planes, and of hits with {} cells or the \
        next number.\n\n\
        | shape | triangles | volumetric ÷ uniform, 50 | {most} | smart ÷ uniform, {most} | planes used | pieces | Luv smart | texels \
        apart | error planes | error hits | of the reference |\n|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n",
        e.water_cells
    );
    for mesh in &e.meshes {
        let (Some(half), Some(full)) = (near(mesh, 50), near(mesh, most)) else {
            continue;
        };
        let hit = mesh.hits.iter().min_by_key(|h| {
            (
                h.water_cells.abs_diff(e.water_cells),
                std::cmp::Reverse(h.split_levels),
            )
        });
        let error = |value: Option<f64>| value.map_or_else(String::new, percent);
        let over = |p: &PlanePoint| ratio(p.volumetric.ms.median, p.uniform.ms.median);
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |",
            mesh.name,
            mesh.triangles,
            over(half),
            over(full),
            ratio(full.smart.ms.median, full.uniform.ms.median),
            full.used,
            full.sub_boxes,
            luv(full.luv_smart),
            full.texels_apart,
            error(full.uniform.error),
            error(hit.and_then(|h| h.figures.error)),
            error(mesh.truth_error),
        );
    }
    differences(text, e, most);
    budgets(text, e);
}

/// The median: the middle value, or the mean of the two middle values.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let (low, high) = (values.len().saturating_sub(1) / 2, values.len() / 2);
    match (values.get(low), values.get(high)) {
        (Some(a), Some(b)) => 0.5 * (a + b),
        _ => f64::NAN,
    }
}

/// Our ratios and distances over all shapes, and why they differ from the thesis's.
fn differences(text: &mut String, e: &Experiment, most: u32) {
    let points = || e.meshes.iter().flat_map(|m| &m.planes);
    let equal = points().filter(|p| p.luv_smart == 0.0).count();
    let all = points().count();
    let over = |planes: u32, of: fn(&PlanePoint) -> f64| {
        let points = e.meshes.iter().filter_map(|m| near(m, planes));
        median(points.map(of).collect())
    };
    let volumetric = |p: &PlanePoint| p.volumetric.ms.median / p.uniform.ms.median;
    let smart = |p: &PlanePoint| p.smart.ms.median / p.uniform.ms.median;
    let used = |p: &PlanePoint| f64::from(p.used) / f64::from(p.planes);
    let mean = |of: fn(&PlanePoint) -> f64| points().map(of).sum::<f64>() / (all as f64).max(1.0);
    let _ = write!(
        text,
        "\nThe median over the shapes of volumetric ÷ uniform is {} at about 50 planes and {} at {most}; the thesis has 2.8 and 2.7. Our \
        ratio shows what level maps save: a beam is tested only with planes near the surface that the map holds under it, while \
        slices, which are drawn again for every frame, take every beam on every plane. Where a surface is steep or rough \
        everywhere, more planes are near each beam, and the ratio is smaller. If each beam were tested with each plane, as in \
        the thesis, the two techniques would cost nearly the same here, because reading the map costs about as much as reading a \
        slice's texel.\n\n\
        The median of smart ÷ uniform is {} at {most} planes, with {} of the planes in use. The time of smart slicing depends on the \
        number of planes in use. It saves a little less here than in the thesis, because the planes that it omits are cheap in \
        our uniform slicing too, which rejects them early. Our dolphin is another model in another pose than the thesis's \
        (0.98), and has a surface near fewer planes; teapot (0.64) and sphere (0.52) agree.\n\n\
        Smart slicing gives the picture of uniform slicing in {equal} of {all} settings; the mean CIE Luv distance over all is {}. Volumetric \
        differs where a texel's depth is on the border of two slices to the last bits, because clipping a triangle there changes \
        the rasterised depth; its mean distance is {}.\n",
        significant(over(50, volumetric), 3),
        significant(over(most, volumetric), 3),
        significant(over(most, smart), 3),
        percent(over(most, used)),
        luv(mean(|p| p.luv_smart)),
        luv(mean(|p| p.luv_volumetric)),
    );
}

/// In how many settings hits are more accurate than planes in the same time.
fn budgets(text: &mut String, e: &Experiment) {
    let mut settings = 0;
    let mut beaten = 0;
    let mut gains = Vec::new();
    let mut not_beaten = Vec::new();
    for mesh in &e.meshes {
        let points = mesh.planes.iter().flat_map(|p| {
            [
                ("volumetric", p, p.volumetric),
                ("uniform", p, p.uniform),
                ("smart", p, p.smart),
            ]
        });
        for (technique, p, figures) in points {
            let Some(error) = figures.error else { continue };
            settings += 1;
            let in_time = mesh
                .hits
                .iter()
                .filter(|hit| hit.figures.ms.median <= figures.ms.median);
            let best = in_time
                .filter_map(|hit| hit.figures.error)
                .fold(f64::INFINITY, f64::min);
            if best <= error {
                beaten += 1;
                gains.push(error / best);
            } else {
                not_beaten.push(format!(
                    "{} with {} planes, {technique}",
                    mesh.name, p.planes
                ));
            }
        }
    }
    if settings == 0 {
        return;
    }
    let _ = write!(
        text,
        "\n## Error in a given time\n\nIn {beaten} of {settings} settings of planes and slices, placement by hits with some \
        number of water cells takes no longer and is nearer to the reference: in the median {} times nearer. The plots of error against time above show by how much.",
        significant(median(gains), 3),
    );
    if not_beaten.is_empty() {
        text.push('\n');
    } else {
        let _ = writeln!(text, " Exceptions: {}.", not_beaten.join("; "));
    }
}

fn memory(text: &mut String, e: &Experiment) {
    let m = e.memory;
    let _ = write!(
        text,
        "\n## Memory\n\nThe example of §5.1: 100 objects of 512² texels and 100 planes. The thesis compares 100 MB of level \
        maps (two textures of 16 bits) with 5000 MB of slices, a factor of 50. Here level maps with front and back pyramids and normals \
        take {} MiB; slice images of four bytes a texel would take {} MiB if those of all objects were kept as in the thesis, a \
        factor of {}. \
        This program keeps the slices of one object at a time. A plane costs two words in addition to a level map.\n\n\
        Additional memory for more planes, by our own account and by the allocator:\n\n\
        | shape | planes | volumetric, bytes more | by the allocator | level map, bytes more | by the allocator |\n\
        |---|---:|---:|---:|---:|---:|\n",
        mib(m.level_maps_bytes),
        mib(m.slices_bytes),
        significant(
            m.slices_bytes as f64 / (m.level_maps_bytes as f64).max(1.0),
            3
        ),
    );
    for mesh in FEATURED
        .iter()
        .filter_map(|name| e.meshes.iter().find(|mesh| mesh.name == *name))
    {
        let (Some(few), Some(many)) = (mesh.planes.first(), mesh.planes.last()) else {
            continue;
        };
        let more = |few: u64, many: u64| (i128::from(many) - i128::from(few)).to_string();
        let allocated = |few: &TechniqueFigures, many: &TechniqueFigures| {
            let both = few.allocated_bytes.zip(many.allocated_bytes);
            both.map_or_else(String::new, |(few, many)| more(few, many))
        };
        let _ = writeln!(
            text,
            "| {} | {} to {} | {} | {} | {} | {} |",
            mesh.name,
            few.planes,
            many.planes,
            more(few.volumetric.peak_bytes, many.volumetric.peak_bytes),
            allocated(&few.volumetric, &many.volumetric),
            more(few.uniform.peak_bytes, many.uniform.peak_bytes),
            allocated(&few.uniform, &many.uniform),
        );
    }
}
