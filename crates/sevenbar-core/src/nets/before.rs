//! What is known while links are solved together: where others are, and what the held step welds.

use super::net::Net;
use super::rows::On;
use crate::rigid::Pose;

/// The poses of links before them, the step that is held, from which step it leads, and where; the size [length] of the net.
pub(super) struct Before<'a> {
    pub poses: &'a [Pose],
    pub held: usize,
    pub from: On,
    pub moved: Pose,
    pub size: f64,
}

/// How one link is ahead of another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ahead {
    /// They are the same.
    Not,
    /// By what the held step moves, or by the inverse of it.
    ByHeld,
    BehindHeld,
}

/// How a link is ahead of another, if it is the same one or the held step, which leads from one, welds them.
pub(super) fn ahead(on: On, link: usize, held: usize, from: On) -> Option<Ahead> {
    if on == Some(link) {
        Some(Ahead::Not)
    } else if on == Some(held) && from == Some(link) {
        Some(Ahead::ByHeld)
    } else if on == from && on.is_some() && held == link {
        Some(Ahead::BehindHeld)
    } else {
        None
    }
}

impl Before<'_> {
    /// The pose of a link against another that is the same one, or that the held step welds to it; `None` of any other.
    pub fn offset(&self, on: On, link: usize) -> Option<Pose> {
        Some(match ahead(on, link, self.held, self.from)? {
            Ahead::Not => Pose::STILL,
            Ahead::ByHeld => self.moved,
            Ahead::BehindHeld => self.moved.inverse(),
        })
    }

    /// The pose of a step that moves by so much [rad, or length] from where it is drawn.
    pub fn moved_by(&self, net: &Net, step: usize, by: f64) -> Pose {
        let base = net.steps[step].parent.map_or(Pose::STILL, |p| self.poses[p]);
        base.then(&net.moving_by(step, by))
    }

    /// Places the link that the held step welds to one of these, which are placed.
    pub fn weld(&self, poses: &mut [Pose], links: &[usize]) {
        let Some(from) = self.from else { return };
        if links.contains(&from) {
            poses[self.held] = poses[from].then(&self.moved);
        } else if links.contains(&self.held) {
            poses[from] = poses[self.held].then(&self.moved.inverse());
        }
    }
}
