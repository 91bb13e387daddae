module seam_lines
  !! Seams: the lines of edges that leave extraordinary points and go straight on, through regular
  !! vertices, to another extraordinary point, to the boundary or to a crease; and short seams.
  !!
  !! Across a seam the surface has one tangent plane, but the parametrisation may turn: with knot
  !! intervals d along the seam, q and r across it on its two sides (of f and g), every function
  !! satisfies
  !!
  !!     f_,v/q + g_,v/r = A f_,u/d
  !!
  !! A = 2 cos(2 pi/n) at a point of n faces in the direction away from it (2 cos(a/m) at a vertex
  !! of m > 2 faces and the angle a on the boundary). A is linear in the knots along the whole seam,
  !! and 0 on the boundary and on creases, whose curves run through smoothly. Bicubics suffice:
  !! where the trace of f on the seam is a C2 cubic, the right-hand side is a C1 cubic as the
  !! left-hand side.
  !!
  !! Two such seams cannot cross: smooth traces of both would make A vanish there. Seams that
  !! would cross others are short. A short seam is one edge of the mesh that seams are laid in,
  !! u = 0 ... 1 from the point, with
  !!
  !!     A = 2 cos(2 pi/n) (1 - u)^2
  !!
  !! At its far end A = A' = 0: it fades into a regular mesh line, or touches another seam, and
  !! any number of short seams may end in one vertex. Under refinement it keeps its length and its
  !! A, as the long ones, so that the finer spaces approximate with full order as well. The
  !! right-hand side is of degree 4: unstructured_spline adds what a cubic lacks.
  !!
  !! Knot intervals are given before seams are laid: A is smooth in them.
  !!
  !! A belongs to the mesh alone, so that functions and surface share it: functions are C1 on the
  !! surface wherever the control points lie (Groisser, Peters, CAGD 34, 2015), and spaces with
  !! linear factors have the full order of approximation (Collin, Sangalli, Takacs, CAGD 47, 2016:
  !! analysis-suitable G1), with quadratic ones if the degree is raised by one. Why this
  !! construction for Kirchhoff-Love shells in contact: the parametrisation is regular, so that
  !! metric, normal, curvature and closest-point projection exist at the point as anywhere.
  !! D-patches and other degenerate patches have det J = 0 there, which projections would meet at
  !! the pole of a hemisphere; Verhelst and others (CMAME 419, 2024) find them badly conditioned
  !! and their stresses disturbed near the points, where analysis-suitable G1 splines converge at
  !! the full rate. One function a vertex with bi-quartic templates (Scott and others, CMAME 254,
  !! 2013) leaves the point too stiff in bending. Bilinear stars and constant curvature on them
  !! are in the space of long seams exactly.
  use kinds, only: wp
  use quad_mesh, only: quad_mesh_type, next_corner
  implicit none (type, external)
  private
  public :: find_seams, find_short_seams, halve_seams, straight_on, binds, touching_gluing

contains

  pure integer function straight_on(mesh, c)
    !! The edge that continues an edge at a regular vertex of four faces.
    type(quad_mesh_type), intent(in) :: mesh
    integer, intent(in) :: c                 !! corner that the edge starts from

    straight_on = next_corner(mesh%twin(next_corner(c)))
  end function straight_on

  pure logical function binds(mesh, c, k)
    !! Whether a seam's condition says something at an end of an edge: it does not where a short
    !! seam fades.
    type(quad_mesh_type), intent(in) :: mesh
    integer, intent(in) :: c                 !! corner that the edge starts from
    integer, intent(in) :: k                 !! 1: at its start, 2: at its end

    binds = mesh%seam(c) .and. .not. mesh%fades(k,c)
  end function binds

  pure function touching_gluing(mesh, c, k) result(a)
    !! Both end values of the linear function that touches A at one end of an edge.
    type(quad_mesh_type), intent(in) :: mesh
    integer, intent(in) :: c                 !! corner that the edge starts from
    integer, intent(in) :: k                 !! 1: touches at its start, 2: at its end
    real(wp) :: a(2)

    a = mesh%gluing(:,c)
    a(3-k) = a(3-k) - mesh%bend(c)
  end function touching_gluing

  subroutine find_seams(mesh)
    !! Long seams where they cross no others.
    type(quad_mesh_type), intent(inout) :: mesh

    call lay_seams(mesh, .false.)
  end subroutine find_seams

  subroutine find_short_seams(mesh)
    !! No seam goes further than one edge.
    type(quad_mesh_type), intent(inout) :: mesh

    call lay_seams(mesh, .true.)
  end subroutine find_short_seams

  subroutine lay_seams(mesh, short_only)
    type(quad_mesh_type), intent(inout) :: mesh
    logical, intent(in) :: short_only

    integer, allocatable :: edges(:), spoke(:)
    logical, allocatable :: is_short(:)
    integer :: l, n

    mesh%has_seams = .true.
    mesh%seam = .false.
    mesh%gluing = 0
    mesh%bend = 0
    mesh%fades = .false.
    call find_lines(mesh, spoke, is_short)
    do l = 1, size(spoke)
      edges = line_from(mesh, spoke(l))
      n = size(edges)
      if (n > 1 .and. (is_short(l) .or. short_only)) then
        call lay_short(mesh, edges(1))
        if (mesh%is_star(mesh%vertex(next_corner(edges(n))))) &
          call lay_short(mesh, mesh%twin(edges(n)))
      else
        call lay_long(mesh, edges)
      end if
    end do
  end subroutine lay_seams

  subroutine find_lines(mesh, spoke, crosses)
    !! Straight lines from all extraordinary points, each once.
    type(quad_mesh_type), intent(in) :: mesh
    integer, allocatable, intent(out) :: spoke(:)      !! corner that each line starts from (nl)
    logical, allocatable, intent(out) :: crosses(:)    !! whether it crosses another, or itself (nl)

    integer, allocatable :: edges(:), line(:), lines_at(:), start(:)
    integer :: c, k, n, v

    allocate (line(4*mesh%nf), start(4*mesh%nf), source=0)
    n = 0
    do v = 1, mesh%nv
      if (.not. mesh%is_star(v)) cycle
      c = mesh%corner(v)
      do k = 1, mesh%faces(v)
        if (.not. mesh%crease(c) .and. line(c) == 0) then
          n = n + 1
          start(n) = c
          edges = line_from(mesh, c)
          line(edges) = n
          line(mesh%twin(edges)) = n
        end if
        c = mesh%turn(c)
      end do
    end do
    allocate (spoke, source=start(1:n))
    allocate (crosses(n), source=.false.)
    allocate (lines_at(mesh%nv), source=0)
    do c = 1, 4*mesh%nf
      if (line(c) > 0) lines_at(mesh%vertex(c)) = lines_at(mesh%vertex(c)) + 1
    end do
    do c = 1, 4*mesh%nf
      if (line(c) == 0) cycle
      v = mesh%vertex(c)
      if (lines_at(v) == 4 .and. .not. (mesh%is_star(v) .or. has_crease(mesh, v))) &
        crosses(line(c)) = .true.
    end do
  end subroutine find_lines

  pure function line_from(mesh, spoke) result(edges)
    !! Straight on from an extraordinary point to the next one, the boundary or a crease.
    type(quad_mesh_type), intent(in) :: mesh
    integer, intent(in) :: spoke             !! corner at the point
    integer, allocatable :: edges(:)         !! corners that the edges start from

    integer :: c, n, pass, w

    do pass = 1, 2
      c = spoke
      n = 0
      do
        n = n + 1
        if (pass == 2) edges(n) = c
        w = mesh%vertex(next_corner(c))
        if (mesh%is_star(w) .or. has_crease(mesh, w)) exit
        c = straight_on(mesh, c)
      end do
      if (pass == 1) allocate (edges(n))
    end do
  end function line_from

  subroutine lay_long(mesh, edges)
    !! A linear in the knots.
    type(quad_mesh_type), intent(inout) :: mesh
    integer, intent(in) :: edges(:)

    real(wp) :: a(2), at, length
    integer :: k, w

    w = mesh%vertex(next_corner(edges(size(edges))))
    a(1) = 2*cos(mesh%angle(mesh%vertex(edges(1))))
    a(2) = 0
    if (mesh%is_star(w)) a(2) = -2*cos(mesh%angle(w))
    length = sum(mesh%interval(edges))
    at = 0
    do k = 1, size(edges)
      associate (h => mesh%interval(edges(k)))
        call set_seam(mesh, edges(k), a(1) + (a(2) - a(1))*[at, at + h]/length, 0.0_wp, &
          [.false., .false.])
        at = at + h
      end associate
    end do
  end subroutine lay_long

  subroutine lay_short(mesh, spoke)
    type(quad_mesh_type), intent(inout) :: mesh
    integer, intent(in) :: spoke             !! corner at the extraordinary point

    real(wp) :: a

    a = 2*cos(mesh%angle(mesh%vertex(spoke)))
    call set_seam(mesh, spoke, [a, 0.0_wp], a, [.false., .true.])
  end subroutine lay_short

  subroutine set_seam(mesh, c, a, bend, fades)
    !! On both sides of an edge.
    type(quad_mesh_type), intent(inout) :: mesh
    integer, intent(in) :: c                 !! corner that the edge starts from
    real(wp), intent(in) :: a(2), bend
    logical, intent(in) :: fades(2)

    mesh%seam(c) = .true.
    mesh%gluing(:,c) = a
    mesh%bend(c) = bend
    mesh%fades(:,c) = fades
    associate (t => mesh%twin(c))
      mesh%seam(t) = .true.
      mesh%gluing(:,t) = -a([2, 1])
      mesh%bend(t) = -bend
      mesh%fades(:,t) = fades([2, 1])
    end associate
  end subroutine set_seam

  subroutine halve_seams(mesh, finer)
    !! The seams of a mesh in the one whose faces are its quarters.
    type(quad_mesh_type), intent(in) :: mesh
    type(quad_mesh_type), intent(inout) :: finer   !! as split_faces numbers it

    real(wp) :: middle
    integer :: c

    finer%has_seams = mesh%has_seams
    do c = 1, 4*mesh%nf
      if (.not. mesh%seam(c)) cycle
      if (mesh%twin(c) < c) cycle
      associate (a => mesh%gluing(:,c), bend => mesh%bend(c))
        middle = (sum(a) - bend/2)/2
        call set_seam(finer, 4*c - 3, [a(1), middle], bend/4, [mesh%fades(1,c), .false.])
        call set_seam(finer, 4*next_corner(c), [middle, a(2)], bend/4, [.false., mesh%fades(2,c)])
      end associate
    end do
  end subroutine halve_seams

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
