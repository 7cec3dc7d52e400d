//! FANUC's web pages: where the robot is, and which programs run.

use crate::device::robot::curpos::http::{self, Response};
use crate::device::robot::curpos::page::{self, CurposPage};
use crate::device::robot::mappdk::messages::Xyzwpr;
use crate::device::sim::fault::Fault;
use crate::device::sim::net::Connection;
use crate::device::sim::world::World;
use crate::geometry::Transform;

/// Lists the programs.
const PROGRAMS_PATH: &str = "/MD/PRGSTATE.DG";
/// The frame and the tool that the MAPPDK server makes active; both are zero.
const FRAME_AND_TOOL: u8 = 8;

/// Answers one request, then closes.
pub fn serve(world: &World, connection: &mut Connection) {
    let mut asked = None;
    let head = connection.receive(|bytes| match http::parse_get(bytes) {
        Ok(None) => None,
        Ok(Some(path)) => {
            asked = Some(path);
            Some(bytes.len())
        }
        Err(_) => Some(bytes.len()),
    });
    let response = match (head, asked) {
        (None, _) => return,
        (_, Some(path)) if path.eq_ignore_ascii_case(page::PATH) => found(position(world).encode()),
        (_, Some(path)) if path.eq_ignore_ascii_case(PROGRAMS_PATH) => found(programs(world)),
        (_, Some(_)) => Response { status: 404, body: b"no such page".to_vec() },
        (_, None) => Response { status: 400, body: b"GET is all that is answered".to_vec() },
    };
    // Closed next in any case.
    let _ = connection.send(&response.encode());
}

fn found(page: String) -> Response {
    Response { status: 200, body: page.into_bytes() }
}

fn position(world: &World) -> CurposPage {
    let arm = world.arm();
    let world_pose = Xyzwpr::from_pose(&Transform::from_rigid(arm.base_from_flange));
    CurposPage {
        tool: FRAME_AND_TOOL,
        frame: FRAME_AND_TOOL,
        joints_deg: arm.shown_deg.to_vec(),
        in_user_frame: world_pose,
        world: world_pose,
    }
}

fn programs(world: &World) -> String {
    let state = if world.has(Fault::NotRemote) { "ABORTED" } else { "RUNNING" };
    format!(
        "<HTML><BODY><PRE>\r\nMAPPDK_SERVER {state} @ 49 in OPEN_COMM of MAPPDK_SERVER\r\nMAPPDK_LOGGER {state} @ 49 in OPEN_COMM of MAPPDK_LOGGER\r\n</PRE></BODY></HTML>\r\n"
    )
}
