module seam_lines
  !! Seams: the lines of edges that leave extraordinary points and go straight on, through regular
  !! vertices, to another extraordinary point, to the boundary or to a crease.
  !!
  !! Across a seam the surface has one tangent plane, but the parametrisation may turn: with knot
  !! intervals d along the seam, q and r across it on its two sides (of f and g), every function
  !! satisfies
  !!
  !!     f_,v/q + g_,v/r = A f_,u/d,     A linear in the knots along the whole seam,
  !!
  !! A = 2 cos(2 pi/n) at a point of n faces in the direction away from it (2 cos(a/m) at a vertex
  !! of m > 2 faces and the angle a on the boundary), and 0 on the boundary and on creases, whose
  !! curves run through smoothly. Bicubics suffice: where the trace of f on the seam is a C2 cubic,
  !! the right-hand side is a C1 cubic as the left-hand side.
  !!
  !! A belongs to the mesh alone, so that functions and surface share it: functions are C1 on the
  !! surface wherever the control points lie (Groisser, Peters, CAGD 34, 2015), and spaces with
  !! linear
  !! factors have the full order of approximation (Collin, Sangalli, Takacs, CAGD 47, 2016:
  !! analysis-
  !! suitable G1). Why this construction for Kirchhoff-Love shells in contact: the parametrisation
  !! is regular, so that metric, normal, curvature and closest-point projection exist at the point
  !! as anywhere. D-patches and other degenerate patches have det J = 0 there, which projections
  !! would meet at the pole of a hemisphere; Verhelst and others (CMAME 419, 2024) find them badly
  !! conditioned and their stresses disturbed near the points, where analysis-suitable G1 splines
  !! converge at the full rate. One function a vertex with bi-quartic templates (Scott and others,
  !! CMAME 254, 2013) leaves the point too stiff in bending. Bilinear stars and constant
  !! curvature on them are in this space exactly.
  !!
  !! Two seams cannot cross (smooth traces of both would make A vanish there). Extraordinary points
  !! whose seams cross, or touch the faces of such a point, or end at such a point, are `compact`
  !! instead (extraordinary_ring).
  use kinds, only: wp
  use quad_mesh, only: quad_mesh_type, next_corner, previous_corner, face_of
  implicit none (type, external)
  private
  public :: find_seams, straight_on

contains

  pure integer function straight_on(mesh, c)
    !! The edge that continues an edge at a regular vertex of four faces.
    type(quad_mesh_type), intent(in) :: mesh
    integer, intent(in) :: c                 !! corner that the edge starts from

    straight_on = next_corner(mesh%twin(next_corner(c)))
  end function straight_on

  subroutine find_seams(mesh)
    !! Sets seam, gluing and compact.
    type(quad_mesh_type), intent(inout) :: mesh

    integer, allocatable :: owner(:), spokes(:)
    logical :: changed
    integer :: c, k, v

    mesh%compact = .false.
    do
      mesh%seam = .false.
      mesh%gluing = 0
      allocate (owner(4*mesh%nf), spokes(mesh%nv), source=0)
      changed = .false.
      do v = 1, mesh%nv
        if (.not. mesh%is_star(v) .or. mesh%compact(v)) cycle
        c = mesh%corner(v)
        do k = 1, mesh%faces(v)
          if (.not. mesh%crease(c)) call follow(mesh, c, owner, changed)
          c = mesh%turn(c)
        end do
      end do
      ! crossings, and seams along faces of compact points
      do c = 1, 4*mesh%nf
        if (mesh%seam(c)) spokes(mesh%vertex(c)) = spokes(mesh%vertex(c)) + 1
      end do
      do c = 1, 4*mesh%nf
        if (.not. mesh%seam(c)) cycle
        v = mesh%vertex(c)
        if (spokes(v) == 4 .and. .not. mesh%is_star(v)) call give_up(owner(c))
        if (touches_compact(mesh, face_of(c))) call give_up(owner(c))
      end do
      deallocate (owner, spokes)
      if (.not. changed) exit
    end do

  contains

    subroutine give_up(point)
      integer, intent(in) :: point           !! extraordinary point

      changed = changed .or. .not. mesh%compact(point)
      mesh%compact(point) = .true.
    end subroutine give_up
  end subroutine find_seams

  pure logical function touches_compact(mesh, f)
    type(quad_mesh_type), intent(in) :: mesh
    integer, intent(in) :: f                 !! face

    touches_compact = any(mesh%compact(mesh%vertex(4*f-3:4*f)))
  end function touches_compact

  subroutine follow(mesh, spoke, owner, changed)
    !! Marks the seam of a spoke.
    type(quad_mesh_type), intent(inout) :: mesh
    integer, intent(in) :: spoke             !! corner at an extraordinary point
    integer, intent(inout) :: owner(:)       !! point that an edge's seam comes from, or one of two
    logical, intent(inout) :: changed        !! a point has become compact

    real(wp) :: a(2), at, length
    integer :: c, step, v, w

    v = mesh%vertex(spoke)
    c = spoke
    length = 0
    a(1) = 2*cos(mesh%angle(v))
    a(2) = 0
    do step = 1, 4*mesh%nf
      length = length + mesh%interval(c)
      w = mesh%vertex(next_corner(c))
      if (mesh%is_star(w)) then
        if (mesh%compact(w)) then
          mesh%compact(v) = .true.
          changed = .true.
          return
        end if
        a(2) = -2*cos(mesh%angle(w))
        exit
      end if
      if (has_crease(mesh, w)) exit
      c = straight_on(mesh, c)
    end do
    c = spoke
    at = 0
    do
      mesh%seam(c) = .true.
      mesh%seam(mesh%twin(c)) = .true.
      owner(c) = v
      owner(mesh%twin(c)) = v
      mesh%gluing(1,c) = a(1) + (a(2) - a(1))*at/length
      at = at + mesh%interval(c)
      mesh%gluing(2,c) = a(1) + (a(2) - a(1))*at/length
      mesh%gluing(:,mesh%twin(c)) = -mesh%gluing(2:1:-1,c)
      w = mesh%vertex(next_corner(c))
      if (mesh%is_star(w) .or. has_crease(mesh, w)) exit
      c = straight_on(mesh, c)
    end do
  end subroutine follow

  pure logical function has_crease(mesh, v)
    type(quad_mesh_type), intent(in) :: mesh
    integer, intent(in) :: v                 !! vertex

    integer :: c, k

    has_crease = .true.
    c = mesh%corner(v)
    do k = 1, mesh%faces(v)
      if (mesh%crease(c)) return
      c = mesh%turn(c)
      if (c == 0) return
    end do
    has_crease = .false.
  end function has_crease
end module seam_lines
