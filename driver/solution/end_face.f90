module end_face
  !! The geometry and kinematics of an end face that turns by a finite angle theta about an axis n through its centroid C.
  !!
  !! A rigid face carries its control points along:
  !!     u_a = t + (R(theta) - I) r_a,    r_a = X_a - C.
  !! A face that is free to warp turns in the mean: theta is defined by
  !!     Phi = sum_a (r_a + u_a) . R(theta) lever_a = 0,    lever_a = int N_a n x (X - C) dA / J,
  !!     J = int |n x (X - C)|**2 dA,
  !! which holds for a rigid motion, and whose multiplier is (but for the sign) the moment: it acts as the traction
  !! M R n x (X - C) / J, in the plane the linear distribution of beam theory. R v by Rodrigues' formula.
  use kinds, only: wp
  use status_codes, only: ok
  use model_data, only: model_type
  use facets, only: facet_surface, build_facets
  use gauss_rules, only: tensor_rule
  use rational_basis, only: shape_functions
  implicit none (type, external)
  private
  public :: end_face_geometry, build_end_face, turn

  type :: end_face_geometry
    logical :: rigid = .true.
    integer :: rotation = 0                !! column of control values that holds theta and the multiplier
    integer :: translation = 0             !! column that holds t, 0: the face is free to warp
    real(wp) :: axis(3) = [0, 0, 1]        !! n
    real(wp) :: centroid(3) = 0            !! C [length]
    real(wp) :: radius = 0                 !! sqrt(J/A) [length]
    integer, allocatable :: nodes(:)
    real(wp), allocatable :: arm(:, :)     !! r_a (ndm,nodes) [length]
    real(wp), allocatable :: lever(:, :)   !! (ndm,nodes) [1/length]
  end type end_face_geometry

contains

  subroutine build_end_face(model, number, face, status)
    type(model_type), intent(in), target :: model
    integer, intent(in) :: number                   !! index into model%end_faces
    type(end_face_geometry), intent(out) :: face
    integer, intent(out) :: status                  !! ok, or what is wrong with a facet
    type(facet_surface), target :: surface
    integer, pointer, contiguous :: nodes(:)
    integer, allocatable :: place(:)
    real(wp), allocatable :: shp(:, :), area(:)
    real(wp) :: point(3), total, inertia, moved(3)
    integer :: f, g, a, n

    associate (asked => model%end_faces(number))
      face%rigid = .not. asked%warps
      face%rotation = asked%rotation
      face%translation = asked%translation
      face%axis = asked%axis
      call build_facets(model, asked%set, surface)
    end associate
    allocate (place(model%nn), source=0)
    n = 0
    do f = 1, surface%set%ne
      nodes => surface%set%connectivity(f)
      do a = 1, size(nodes)
        if (place(nodes(a)) > 0) cycle
        n = n + 1
        place(nodes(a)) = n
      end do
    end do
    allocate (face%nodes(n))
    do a = 1, model%nn
      if (place(a) > 0) face%nodes(place(a)) = a
    end do

    total = 0
    do f = 1, surface%set%ne
      nodes => surface%set%connectivity(f)
      call facet_points(model, surface, f, shp, area, status)
      if (status /= ok) return
      do g = 1, size(area)
        face%centroid = face%centroid + area(g)*padded(matmul(model%x(:, nodes), shp(:, g)))
        total = total + area(g)
      end do
    end do
    face%centroid = face%centroid/total
    allocate (face%arm(model%ndm, n), face%lever(model%ndm, n))
    face%lever = 0
    do a = 1, n
      face%arm(:, a) = model%x(:, face%nodes(a)) - face%centroid(1:model%ndm)
    end do
    inertia = 0
    do f = 1, surface%set%ne
      nodes => surface%set%connectivity(f)
      call facet_points(model, surface, f, shp, area, status)
      if (status /= ok) return
      do g = 1, size(area)
        point = padded(matmul(model%x(:, nodes), shp(:, g))) - face%centroid
        moved = cross(face%axis, point)
        inertia = inertia + area(g)*dot_product(moved, moved)
        do a = 1, size(nodes)
          face%lever(:, place(nodes(a))) = face%lever(:, place(nodes(a))) + area(g)*shp(a, g)*moved(1:model%ndm)
        end do
      end do
    end do
    face%lever = face%lever/inertia
    face%radius = sqrt(inertia/total)
  end subroutine build_end_face

  subroutine facet_points(model, surface, f, shp, area, status)
    !! Functions and areas of a facet at its Gauss points, exact for the moments of polynomial facets.
    type(model_type), intent(in) :: model
    type(facet_surface), intent(in), target :: surface
    integer, intent(in) :: f
    real(wp), allocatable, intent(out) :: shp(:, :)    !! (nen,ng)
    real(wp), allocatable, intent(out) :: area(:)      !! (ng) [length**dp]
    integer, intent(out) :: status
    integer, pointer, contiguous :: nodes(:)
    real(wp), allocatable :: xi(:, :), dshp(:, :)
    real(wp) :: d2shp(0, 0), tangent(3, 2)
    integer :: dp, g, d, rule(2)

    dp = surface%set%dp(f)
    nodes => surface%set%connectivity(f)
    rule(1:dp) = 2*surface%set%degree(1:dp, f) + 1
    allocate (xi(dp, product(rule(1:dp))), area(product(rule(1:dp))), shp(size(nodes), product(rule(1:dp))))
    allocate (dshp(dp, size(nodes)))
    call tensor_rule(rule(1:dp), xi, area)
    do g = 1, size(area)
      call shape_functions(surface%set%degree(1:dp, f), model%w(nodes), surface%set%operator(f), xi(:, g), 1, &
                           shp(:, g), dshp, d2shp, status)
      if (status /= ok) return
      tangent = 0
      do d = 1, dp
        tangent(1:model%ndm, d) = matmul(model%x(:, nodes), dshp(d, :))
      end do
      if (dp == 1) area(g) = area(g)*norm2(tangent(:, 1))
      if (dp == 2) area(g) = area(g)*norm2(cross(tangent(:, 1), tangent(:, 2)))
    end do
  end subroutine facet_points

  pure subroutine turn(axis, theta, v, change, first, second)
    !! (R(theta) - I) v, R'(theta) v and R''(theta) v; in the plane about the third direction.
    real(wp), intent(in) :: axis(3)          !! unit vector
    real(wp), intent(in) :: theta
    real(wp), intent(in) :: v(:)             !! (ndm)
    real(wp), intent(out) :: change(:), first(:), second(:)
    real(wp) :: across(3), normal(3)
    integer :: n

    n = size(v)
    normal = padded(v)
    across = cross(axis, normal)
    normal = normal - dot_product(axis, normal)*axis
    change = -2*sin(0.5_wp*theta)**2*normal(1:n) + sin(theta)*across(1:n)  ! cos - 1 without cancellation
    first = -sin(theta)*normal(1:n) + cos(theta)*across(1:n)
    second = -cos(theta)*normal(1:n) - sin(theta)*across(1:n)
  end subroutine turn

  pure function cross(a, b) result(c)
    real(wp), intent(in) :: a(3), b(3)
    real(wp) :: c(3)

    c = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
  end function cross

  pure function padded(v) result(x)
    !! A vector of the plane in space.
    real(wp), intent(in) :: v(:)
    real(wp) :: x(3)

    x = 0
    x(1:size(v)) = v
  end function padded
end module end_face
