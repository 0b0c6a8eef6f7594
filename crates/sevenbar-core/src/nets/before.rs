//! What is known while links are solved together: where others are, and what the held step welds.

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

impl Before<'_> {
    /// The pose of a link against another that is the same one, or that the held step welds to it; `None` of any other.
    pub fn offset(&self, on: On, link: usize) -> Option<Pose> {
        if on == Some(link) {
            Some(Pose::STILL)
        } else if on == Some(self.held) && self.from == Some(link) {
            Some(self.moved)
        } else if on == self.from && on.is_some() && self.held == link {
            Some(self.moved.inverse())
        } else {
            None
        }
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
