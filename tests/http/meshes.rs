//! Meshes are stored, listed, found and deleted.

use std::time::{Duration, Instant};

use axum::http::Method;
use caustica::config::Limits;
use caustica::gpu_queue::QueueSettings;
use caustica::http::ProblemKind;
use caustica::mesh::MeshInfo;
use caustica::render::Prepared;
use caustica::scene::{Scene, resolve};
use serde_json::Value;

use super::support::scenes::OBJ;
use super::support::{Behaviour, Reply, Service, scenes};

const MTL: &str = "newmtl sand\nKd 0.7 0.65 0.5\n";

fn form(parts: &[(&str, &str)]) -> String {
    let mut body = String::new();
    for (name, text) in parts {
        body.push_str(&format!(
            "--edge\r\ncontent-disposition: form-data; name=\"{name}\"; filename=\"a\"\r\n\r\n{text}\r\n"
        ));
    }
    body + "--edge--\r\n"
}

async fn upload(service: &Service, obj: &str) -> Reply {
    service
        .post("/v1/meshes", "model/obj", obj.to_owned())
        .await
}

async fn upload_form(service: &Service, parts: &[(&str, &str)]) -> Reply {
    let media_type = "multipart/form-data; boundary=edge";
    service.post("/v1/meshes", media_type, form(parts)).await
}

#[tokio::test]
async fn the_same_bytes_have_the_same_id() {
    let service = Service::start().await;
    let first = upload(&service, OBJ).await;
    assert_eq!(first.status, 201, "{}", first.text());
    let info: MeshInfo = first.json();
    assert!(info.id.starts_with("blake3:"));
    assert_eq!(first.header("location"), format!("/v1/meshes/{}", info.id));
    for media_type in [
        "text/plain",
        "application/octet-stream",
        "text/plain; charset=utf-8",
    ] {
        let again = service.post("/v1/meshes", media_type, OBJ).await;
        assert_eq!(again.status, 200, "{media_type}");
        assert_eq!(again.json::<MeshInfo>(), info);
    }
    let other = upload(&service, &OBJ.replace("v 1 0 0", "v 2 0 0")).await;
    assert_eq!(other.status, 201);
    assert_ne!(other.json::<MeshInfo>().id, info.id);
}

#[tokio::test]
async fn an_answer_has_triangles_and_bounds() {
    let service = Service::start().await;
    let info: MeshInfo = upload(&service, OBJ).await.json();
    assert_eq!(info.triangles, 4);
    let value = serde_json::to_value(&info).unwrap();
    assert_eq!(value["bounds_m"]["min"], serde_json::json!([0.0, 0.0, 0.0]));
    assert_eq!(value["bounds_m"]["max"], serde_json::json!([1.0, 1.0, 1.0]));
    assert!(value["warnings"].is_array());
}

#[tokio::test]
async fn meshes_are_listed_and_found() {
    let service = Service::start().await;
    let empty: Value = service.get("/v1/meshes").await.json();
    assert_eq!(empty, serde_json::json!({ "meshes": [] }));
    let info: MeshInfo = upload(&service, OBJ).await.json();
    let list: Value = service.get("/v1/meshes").await.json();
    assert_eq!(list["meshes"][0]["id"], info.id);
    let found = service.get(&format!("/v1/meshes/{}", info.id)).await;
    assert_eq!(found.status, 200);
    assert_eq!(found.json::<MeshInfo>(), info);
}

#[tokio::test]
async fn a_forgotten_mesh_is_gone_everywhere() {
    let service = Service::start().await;
    let info: MeshInfo = upload(&service, OBJ).await.json();
    let scene = scenes::small_with_mesh(&info.id);
    assert_eq!(service.post_json("/v1/render", &scene).await.status, 200);

    let path = format!("/v1/meshes/{}", info.id);
    let reply = service.bare(Method::DELETE, &path).await;
    assert_eq!(reply.status, 204);
    assert!(reply.body.is_empty());
    service
        .control
        .wait_for(&format!("forget {}", info.id), 1)
        .await;

    service.get(&path).await.problem(ProblemKind::UnknownMesh);
    let again = service.bare(Method::DELETE, &path).await;
    let problem = again.problem(ProblemKind::UnknownMesh);
    assert!(problem.detail.contains(&info.id));
    let reply = service.post_json("/v1/render", scene).await;
    let problem = reply.problem(ProblemKind::MissingMesh);
    assert_eq!(problem.errors[0].pointer, "/objects/0/mesh");
    assert_eq!(upload(&service, OBJ).await.status, 201);
}

#[tokio::test]
async fn forgetting_comes_before_the_next_job() {
    let service = Service::start().await;
    let info: MeshInfo = upload(&service, OBJ).await.json();
    let path = format!("/v1/meshes/{}", info.id);
    service.bare(Method::DELETE, &path).await;
    service.assert_whole().await;
    let diary = service.control.diary();
    let place = |event: &str| diary.iter().position(|entry| entry == event).unwrap();
    assert!(place(&format!("forget {}", info.id)) < place("render"));
}

#[tokio::test]
async fn maps_that_a_waiting_render_builds_for_a_deleted_mesh_are_freed_too() {
    let service = Service::start().await;
    let info: MeshInfo = upload(&service, OBJ).await.json();
    let path = format!("/v1/meshes/{}", info.id);
    let scene = scenes::small_with_mesh(&info.id);
    let start = |scene: Value| {
        let service = service.clone();
        tokio::spawn(async move { service.post_json("/v1/render", scene).await })
    };
    service.control.script([Behaviour::Block]);
    let running = start(scenes::small());
    service.control.wait_for("render", 1).await;
    // This one has its mesh already, and waits.
    let waiting = start(scene.clone());
    service.until_depth(2).await;
    assert_eq!(service.bare(Method::DELETE, &path).await.status, 204);
    service.control.open_gate();
    assert_eq!(running.await.unwrap().status, 200);
    assert_eq!(waiting.await.unwrap().status, 200);
    service.until_depth(0).await;
    let forgotten = format!("forget {}", info.id);
    let last = |diary: &[String], event: &str| diary.iter().rposition(|e| e == event).unwrap();
    let diary = service.control.diary();
    assert!(
        last(&diary, &forgotten) > last(&diary, "render"),
        "{diary:?}"
    );

    // Stored again it is as good as new: what is built for it stays.
    assert_eq!(upload(&service, OBJ).await.status, 201);
    assert_eq!(service.post_json("/v1/render", &scene).await.status, 200);
    service.assert_whole().await;
    let diary = service.control.diary();
    let renders: Vec<usize> = (0..diary.len()).filter(|&i| diary[i] == "render").collect();
    assert!(
        last(&diary, &forgotten) < renders[renders.len() - 2],
        "{diary:?}"
    );
}

#[tokio::test]
async fn a_mesh_that_is_deleted_while_its_scene_is_prepared_goes_after_the_render() {
    let service = Service::start_queued(QueueSettings {
        waiting: 4,
        deadline: Duration::from_secs(60),
    })
    .await;
    let queue = service.state.queue();
    let place = queue.place(Instant::now()).unwrap();
    queue.forget_mesh("the mesh");
    // Others come and go meanwhile.
    service.assert_whole().await;
    service.assert_whole().await;
    service.until_depth(1).await;
    let scene = Scene::from_value(scenes::small()).unwrap();
    let resolved = resolve(scene, &Limits::default(), |_: &str| None).unwrap();
    let prepared = Prepared::new(resolved).unwrap();
    queue.render(place, prepared).await.unwrap();
    service.assert_whole().await;
    let diary = service.control.diary();
    let renders: Vec<usize> = (0..diary.len()).filter(|&i| diary[i] == "render").collect();
    let (of_place, next) = (renders[renders.len() - 2], renders[renders.len() - 1]);
    let between = &diary[of_place..next];
    assert!(
        between.iter().any(|event| event == "forget the mesh"),
        "{diary:?}"
    );
    // After that, no job is left that could build anything for it.
    let before = service.control.count("forget the mesh");
    service.assert_whole().await;
    let after = service.control.count("forget the mesh");
    assert_eq!(before, after, "{:?}", service.control.diary());
}

#[tokio::test]
async fn materials_come_in_a_form() {
    let service = Service::start().await;
    let obj = format!("mtllib a.mtl\n{}", OBJ.replacen("f ", "usemtl sand\nf ", 1));
    let both = upload_form(&service, &[("mtl", MTL), ("obj", &obj)]).await;
    assert_eq!(both.status, 201, "{}", both.text());
    let alone = upload_form(&service, &[("obj", &obj)]).await;
    assert_eq!(alone.status, 201, "{}", alone.text());
    assert_ne!(both.json::<MeshInfo>().id, alone.json::<MeshInfo>().id);
    // Of several files the first one that has a material counts.
    let several = [("mtl", "newmtl sea\n"), ("mtl", MTL), ("obj", &obj)];
    let several = upload_form(&service, &several).await;
    assert_eq!(several.status, 201, "{}", several.text());
    assert_eq!(
        several.json::<MeshInfo>().materials,
        both.json::<MeshInfo>().materials
    );
    assert_ne!(several.json::<MeshInfo>().id, both.json::<MeshInfo>().id);
}

#[tokio::test]
async fn an_obj_is_the_same_in_a_form_and_alone() {
    let service = Service::start().await;
    let alone: MeshInfo = upload(&service, OBJ).await.json();
    let form = upload_form(&service, &[("obj", OBJ)]).await;
    assert_eq!(form.status, 200);
    assert_eq!(form.json::<MeshInfo>().id, alone.id);
}

#[tokio::test]
async fn bodies_that_are_not_forms() {
    let service = Service::start().await;
    let cases: [&[(&str, &str)]; 4] = [
        &[],
        &[("mtl", MTL)],
        &[("obj", OBJ), ("obj", OBJ)],
        &[("obj", OBJ), ("texture", "")],
    ];
    for parts in cases {
        let reply = upload_form(&service, parts).await;
        reply.problem(ProblemKind::MalformedBody);
    }
    for (media_type, body) in [
        ("multipart/form-data", form(&[("obj", OBJ)])),
        (
            "multipart/form-data; boundary=edge",
            "no form at all".to_owned(),
        ),
        (
            "multipart/form-data; boundary=edge",
            "--edge\r\n".to_owned(),
        ),
    ] {
        let reply = service.post("/v1/meshes", media_type, body).await;
        reply.problem(ProblemKind::MalformedBody);
    }
    assert_eq!(upload(&service, OBJ).await.status, 201);
}

#[tokio::test]
async fn bodies_that_are_not_meshes() {
    let service = Service::start().await;
    for (name, obj) in [
        ("empty", ""),
        ("no face", "v 0 0 0\nv 1 0 0\nv 0 1 0\n"),
        ("index out of range", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n"),
        ("index 0", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n"),
        ("not a number", "v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
        ("infinite", "v 0 0 1e400\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
        ("text", "v a b c\nf 1 1 1\n"),
    ] {
        let reply = upload(&service, obj).await;
        assert_eq!(reply.status, 422, "{name}: {}", reply.text());
        reply.problem(ProblemKind::InvalidMesh);
    }
    assert_eq!(upload(&service, OBJ).await.status, 201);
    service.assert_whole().await;
}

#[tokio::test]
async fn too_many_triangles() {
    let service = Service::start_limited(Limits {
        max_triangles: 3,
        ..Limits::default()
    })
    .await;
    let problem = upload(&service, OBJ)
        .await
        .problem(ProblemKind::InvalidMesh);
    assert!(problem.detail.contains('3'), "{}", problem.detail);
    service.assert_whole().await;
}

#[tokio::test]
async fn a_full_store_says_so() {
    let service = Service::start_limited(Limits {
        mesh_store_bytes: 16,
        ..Limits::default()
    })
    .await;
    let reply = upload(&service, OBJ).await;
    let problem = reply.problem(ProblemKind::MeshStoreFull);
    assert!(!reply.headers.contains_key("retry-after"));
    assert_eq!(problem.budget_bytes, Some(16));
    assert!(problem.needed_bytes.unwrap() > 16);
    service.assert_whole().await;
}
