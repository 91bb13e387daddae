module t_quad_controls
  !! Control points of a T-spline over a quadrilateral mesh: they lie on the mesh, its faces taken
  !! bilinear in the knots, where the means of the inner knots of their functions are (Greville). So
  !! a mesh that is drawn straight and in proportion to its knot intervals stays straight, and
  !! vertices are control points where the intervals about them are even. Around extraordinary
  !! points control points are those of the rings.
  use kinds, only: wp
  use t_quad_mesh, only: t_quad_mesh_type
  use t_quad_rays, only: star_type, star_of, is_plain, side_point, turned
  use t_quad_functions, only: piece_type
  use t_quad_spline, only: t_quad_spline_type
  use spline_controls, only: controls_from_vertices
  implicit none (type, external)
  private
  public :: t_controls_from_vertices

contains

  subroutine t_controls_from_vertices(spline)
    type(t_quad_spline_type), intent(inout) :: spline

    real(wp) :: shift(2)
    integer :: k

    do k = 1, spline%functions%np
      associate (piece => spline%functions%pieces(k))
        if (piece%id == 0) cycle
        shift = (piece%knots(2,:) + piece%knots(4,:))/3
        ! the quadrants of a function agree on the quadrant where the mean of its knots is
        if (any(shift < -1e-9_wp*piece%knots(5,:))) cycle
        call place(spline%mesh, piece, shift, spline%cp(:,piece%id))
      end associate
    end do
    if (any(spline%rings%zone)) call place_rings(spline)
  end subroutine t_controls_from_vertices

  subroutine place(mesh, piece, shift, x)
    type(t_quad_mesh_type), intent(in) :: mesh
    type(piece_type), intent(in) :: piece
    real(wp), intent(in) :: shift(2)             !! from the vertex, in the quadrant
    real(wp), intent(out) :: x(3)

    real(wp) :: p(2)

    p = side_point(mesh, piece%half_edge, mesh%at(piece%half_edge))
    associate (f => mesh%face(piece%half_edge))
      x = mesh%x(:,piece%v) + bilinear(mesh, f, p + turned(shift, piece%axis)) &
        - bilinear(mesh, f, p)
    end associate
  end subroutine place

  pure function bilinear(mesh, f, p) result(x)
    !! Of the corners of a face.
    type(t_quad_mesh_type), intent(in) :: mesh
    integer, intent(in) :: f
    real(wp), intent(in) :: p(2)                 !! in the face
    real(wp) :: x(3)

    real(wp) :: corner(3,0:3), u(2)
    integer :: h

    do h = mesh%first(f), mesh%first(f+1) - 1
      if (mesh%is_corner(h)) corner(:,mesh%side(h)) = mesh%x(:,mesh%vertex(h))
    end do
    u = p/mesh%size(:,f)
    x = (1 - u(1))*(1 - u(2))*corner(:,0) + u(1)*(1 - u(2))*corner(:,1) &
      + u(1)*u(2)*corner(:,2) + (1 - u(1))*u(2)*corner(:,3)
  end function bilinear

  subroutine place_rings(spline)
    !! Their vertices are control points of the T-spline.
    type(t_quad_spline_type), intent(inout) :: spline

    type(star_type) :: star
    integer :: a, v

    associate (rings => spline%rings, functions => spline%functions)
      do v = 1, spline%mesh%nv
        if (rings%local_vertex(v) == 0) cycle
        call star_of(spline%mesh, v, star)
        if (.not. is_plain(star)) cycle
        if (functions%inner(spline%mesh%out(v)) > 0) rings%spline%mesh%x(:,rings%local_vertex(v)) &
          = spline%cp(:,functions%inner(spline%mesh%out(v)))
      end do
      call controls_from_vertices(rings%spline)
      do a = 1, size(rings%id)
        if (rings%own(a) .and. rings%id(a) > 0) &
          spline%cp(:,rings%id(a)) = rings%spline%cp(:,a)
      end do
    end associate
  end subroutine place_rings
end module t_quad_controls
