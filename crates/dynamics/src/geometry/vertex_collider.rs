//! Corners and discs of two bodies against each other and against edges: [`VertexCollider`].

use stickslip_lanes::{Lanes, Mask};

use crate::geometry::contact::Contact;
use crate::geometry::contact_manifold::ContactManifold;
use crate::geometry::edge_search::{EdgeProjection, EdgeSearch};
use crate::geometry::pair::{FirstIds, Pair};
use crate::geometry::rounded_vertex::RoundedVertex;
use crate::geometry::shape::Shape;
use crate::geometry::vec2::{Vec2, add, dot, negate};

/// Slack of the borders of a cone (rad).
const ANGLE: f64 = 1e-9;

/// Finds the contacts of a pair that have a vertex.
pub(crate) struct VertexCollider<'a, const W: usize> {
    pub pair: &'a Pair<'a, Lanes<W>>,
    pub ids: FirstIds,
    /// Lanes in which the two bodies may touch.
    pub active: Mask<W>,
    pub projections: &'a mut Vec<EdgeProjection<W>>,
    pub manifold: &'a mut ContactManifold<W>,
}

impl<const W: usize> VertexCollider<'_, W> {
    /// The other's vertices against the object's edges and vertices, in the object's frame.
    #[inline(always)]
    pub fn collide_other_vertices(&mut self) {
        let object = self.pair.object.shape.outline();
        let count = object.vertices.len();
        for (i, vertex) in self.pair.other.shape.outline().vertices.iter().enumerate() {
            let centre = self.pair.other_in_object.transform_point(vertex.centre);
            let search = self.search(self.pair.object.shape, centre, vertex.radius);
            if !search.active.any() {
                continue;
            }
            self.vertex_on_object(i, vertex, &search);
            for cluster in &object.clusters {
                if !search.may_touch(cluster) {
                    continue;
                }
                for j in cluster.members(count) {
                    let id = self.ids.vertices + (i * count + j) as u32;
                    self.vertex_on_vertex(id, &object.vertices[j], vertex, centre);
                }
            }
        }
    }

    /// The object's vertices against the other's edges, in the other's frame.
    #[inline(always)]
    pub fn collide_object_vertices(&mut self) {
        let object = self.pair.object.shape.outline();
        let limit = self.pair.search_distance + self.pair.other.shape.bounding_radius();
        for cluster in &object.clusters {
            let near = cluster.is_within(limit, self.pair.other_in_object.origin);
            if near.any() {
                for j in cluster.members(object.vertices.len()) {
                    self.vertex_on_other(j, &object.vertices[j]);
                }
            }
        }
    }

    /// The search for the edges under a vertex about `centre`, in the frame of `shape`, in the
    /// lanes where the vertex comes near the shape's bounding disc.
    #[inline(always)]
    fn search<'s>(
        &self,
        shape: &'s Shape,
        centre: Vec2<Lanes<W>>,
        radius: f64,
    ) -> EdgeSearch<'s, W> {
        let limit = self.pair.search_distance + (shape.bounding_radius() + radius);
        let near = limit.gt(Lanes::ZERO) & dot(centre, centre).lt(limit * limit);
        EdgeSearch {
            shape,
            centre,
            active: self.active & near,
            limit: self.pair.search_distance + radius,
            slack: self.pair.slack,
        }
    }

    /// The other's vertex of number `i` against the object's edges.
    #[inline(always)]
    fn vertex_on_object(&mut self, i: usize, vertex: &RoundedVertex, search: &EdgeSearch<'_, W>) {
        let pair = self.pair;
        let edges = &pair.object.shape.outline().edges;
        search.project_onto_edges(
            #[inline(always)]
            |edge| vertex.faces(edge, &pair.other_in_object),
            self.projections,
        );
        for k in 0..self.projections.len() {
            let at = self.projections[k];
            let edge = &edges[at.edge];
            let contact = Contact {
                id: (i * edges.len() + at.edge) as u32,
                present: at.present,
                normal: pair.object.transform.rotate(negate(edge.normal())),
                arm: pair.object.transform.rotate(edge.at(at.s)),
                gap: at.height - vertex.radius,
            };
            if vertex.covered {
                let point = vertex.nearest_point(edge, &pair.other_in_object);
                let hidden = pair.other.shape.hides(point);
                self.manifold.push_unless(hidden, contact);
            } else {
                self.manifold.push(contact);
            }
        }
    }

    /// The object's vertex of number `j` against the other's edges.
    #[inline(always)]
    fn vertex_on_other(&mut self, j: usize, vertex: &RoundedVertex) {
        let pair = self.pair;
        let edges = &pair.other.shape.outline().edges;
        let centre = pair.object_in_other.transform_point(vertex.centre);
        let search = self.search(pair.other.shape, centre, vertex.radius);
        if !search.active.any() {
            return;
        }
        search.project_onto_edges(
            #[inline(always)]
            |edge| vertex.faces(edge, &pair.object_in_other),
            self.projections,
        );
        for k in 0..self.projections.len() {
            let at = self.projections[k];
            let edge = &edges[at.edge];
            let point = vertex.nearest_point(edge, &pair.object_in_other);
            let contact = Contact {
                id: self.ids.other_edges + (j * edges.len() + at.edge) as u32,
                present: at.present,
                normal: pair.other.transform.rotate(edge.normal()),
                arm: pair.object.transform.rotate(point),
                gap: at.height - vertex.radius,
            };
            if vertex.covered {
                let hidden = pair.object.shape.hides(point);
                self.manifold.push_unless(hidden, contact);
            } else {
                self.manifold.push(contact);
            }
        }
    }

    /// A vertex of each body; `centre` is that of the other's one in the object's frame.
    #[inline(always)]
    fn vertex_on_vertex(
        &mut self,
        id: u32,
        object: &RoundedVertex,
        other: &RoundedVertex,
        centre: Vec2<Lanes<W>>,
    ) {
        let d = add(negate(centre), object.centre);
        let limit = self.pair.search_distance + (object.radius + other.radius);
        let mut present = self.active & limit.gt(Lanes::ZERO) & dot(d, d).lt(limit * limit);
        if !present.any() {
            return;
        }
        let back = self.pair.other_in_object.inv_rotate(d);
        present = present
            & object.cone.contains_each(negate(d), self.pair.slack)
            & other.cone.contains_each(back, self.pair.slack);
        if present.any() {
            self.push_vertices(id, object, other, d, present);
        }
    }

    /// Adds the contact of two vertices, where their cones hold its normal; `d` leads from the
    /// other's centre to the object's one.
    #[inline(always)]
    fn push_vertices(
        &mut self,
        id: u32,
        object: &RoundedVertex,
        other: &RoundedVertex,
        d: Vec2<Lanes<W>>,
        mut present: Mask<W>,
    ) {
        // a corner's own edges answer for what is right at it
        let distance = dot(d, d).sqrt();
        if !(object.cone.is_full() && other.cone.is_full()) {
            present = present & distance.gt(Lanes::splat(self.pair.slack));
        }

        // concentric discs have no normal: x is as good as any
        let apart = distance.gt(Lanes::ZERO);
        let inverse = Lanes::splat(1.0) / apart.select(distance, Lanes::splat(1.0));
        let normal = [
            apart.select(d[0] * inverse, Lanes::splat(1.0)),
            apart.zero_unless(d[1] * inverse),
        ];
        let back = self.pair.other_in_object.inv_rotate(normal);
        present = present
            & object.cone.contains_each(negate(normal), ANGLE)
            & other.cone.contains_each(back, ANGLE);

        // the two boundary points, each in its own body's frame
        let object_point = [
            -normal[0] * object.radius + object.centre[0],
            -normal[1] * object.radius + object.centre[1],
        ];
        let other_point = [
            back[0] * other.radius + other.centre[0],
            back[1] * other.radius + other.centre[1],
        ];
        let mut hidden = Mask::splat(false);
        if object.covered {
            hidden = hidden | self.pair.object.shape.hides(object_point);
        }
        if other.covered {
            hidden = hidden | self.pair.other.shape.hides(other_point);
        }

        let contact = Contact {
            id,
            present,
            normal: self.pair.object.transform.rotate(normal),
            arm: self.pair.object.transform.rotate(object_point),
            gap: distance - object.radius - other.radius,
        };
        self.manifold.push_unless(hidden, contact);
    }
}
